set terminal svg size 325,260 enhanced font 'Helvetica,10.67' background '#ffffff'
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
63.5217391,1,,
63.5217391,0.833333333,,
95.6,0.833333333,,
95.6,0.666666667,,
150,0.666666667,,
EOD
$series1 << EOD
0,1,,
22.2692308,1,,
22.2692308,0.833333333,,
60.1325301,0.833333333,,
60.1325301,0.666666667,,
63,0.666666667,,
63,0.5,,
69.9375,0.5,,
69.9375,0.333333333,,
74,0.333333333,,
74,0.166666667,,
110.052632,0.166666667,,
110.052632,0,,
110.052632,0,,
EOD
$series2 << EOD
0,1,,
13.8571429,1,,
13.8571429,0.833333333,,
17.9,0.833333333,,
17.9,0.666666667,,
28.6666667,0.666666667,,
28.6666667,0.5,,
32.5555556,0.5,,
32.5555556,0.333333333,,
32.7333333,0.333333333,,
32.7333333,0.166666667,,
38,0.166666667,,
38,0,,
38,0,,
EOD
plot keyentry with lines lc rgb '#0072b2' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 1000', \
     keyentry with lines lc rgb '#d55e00' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 2000', \
     keyentry with lines lc rgb '#009e73' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 5200', \
     $series2 every 1 using 1:2 with lines lc rgb '#009e73' lw 1.2 notitle, \
     $series1 every 1 using 1:2 with lines lc rgb '#d55e00' lw 1.2 notitle, \
     $series0 every 1 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle
set output
