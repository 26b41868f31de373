set terminal svg size 325,230 enhanced font 'Helvetica,10.67' background '#ffffff'
set encoding utf8
set datafile separator ','
set border 15 lw 0.8
set xtics in mirror scale 0.9,0.5
set ytics in mirror scale 0.9,0.5
set mxtics 2
set mytics 2
set autoscale noextend
set key above horizontal center noautotitle Left reverse samplen 1.2 spacing 0.9
set bars 0.5
set output 'nucleation_a.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'share of runs without an onset'
set ytics 0.2
set format y '%.1f'
set xrange [*:*]
set yrange [0:1]
set offsets graph 0.03, graph 0.03, 0, 0
$series0 << EOD
0,1,,
32.5,1,,
32.5,0.833333333,,
220.333333,0.833333333,,
220.333333,0.666666667,,
281,0.666666667,,
281,0.5,,
353,0.5,,
353,0.333333333,,
485,0.333333333,,
485,0.166666667,,
500,0.166666667,,
EOD
plot keyentry with lines lc rgb '#0072b2' lw 1.2 title '{/:Italic A} = 0.04, {/:Italic N} = 7900', \
     $series0 every 1 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle
set output
