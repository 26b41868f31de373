set terminal svg size 325,245 enhanced font 'Helvetica,10.67' background '#ffffff'
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
23.8181818,1,,
23.8181818,0.666666667,,
193,0.666666667,,
193,0.333333333,,
315,0.333333333,,
315,0,,
315,0,,
EOD
$series1 << EOD
0,1,,
4,1,,
4,0.666666667,,
6.45454545,0.666666667,,
6.45454545,0.333333333,,
115,0.333333333,,
115,0,,
115,0,,
EOD
plot keyentry with lines lc rgb '#0072b2' lw 1.2 title '{/:Italic A} = 0.05, {/:Italic N} = 5200', \
     keyentry with lines lc rgb '#d55e00' lw 1.2 title '{/:Italic A} = 0.05, {/:Italic N} = 18200', \
     $series1 every 1 using 1:2 with lines lc rgb '#d55e00' lw 1.2 notitle, \
     $series0 every 1 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle
set output
