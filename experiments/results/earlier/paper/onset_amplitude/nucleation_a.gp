set terminal svg size 325,275 enhanced font 'Helvetica,10.67' background '#ffffff'
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
8.625,1,,
8.625,0.833333333,,
47.6923077,0.833333333,,
47.6923077,0.666666667,,
55,0.666666667,,
55,0.5,,
58,0.5,,
58,0.333333333,,
60,0.333333333,,
60,0.166666667,,
69,0.166666667,,
69,0,,
69,0,,
EOD
$series1 << EOD
0,1,,
15.6666667,1,,
15.6666667,0.833333333,,
18,0.833333333,,
18,0.5,,
40.3478261,0.5,,
40.3478261,0.333333333,,
62.3333333,0.333333333,,
62.3333333,0.166666667,,
84,0.166666667,,
84,0,,
84,0,,
EOD
$series2 << EOD
0,1,,
12.7,1,,
12.7,0.833333333,,
19.0833333,0.833333333,,
19.0833333,0.666666667,,
21.2592593,0.666666667,,
21.2592593,0.5,,
23.6428571,0.5,,
23.6428571,0.333333333,,
27,0.333333333,,
27,0.166666667,,
28.3529412,0.166666667,,
28.3529412,0,,
28.3529412,0,,
EOD
$series3 << EOD
0,1,,
6.5,1,,
6.5,0.833333333,,
7.11111111,0.833333333,,
7.11111111,0.666666667,,
10.3333333,0.666666667,,
10.3333333,0.5,,
11.1851852,0.5,,
11.1851852,0.333333333,,
11.7,0.333333333,,
11.7,0.166666667,,
18.8,0.166666667,,
18.8,0,,
18.8,0,,
EOD
plot keyentry with lines lc rgb '#0072b2' lw 1.2 title '{/:Italic A} = 0.05, {/:Italic N} = 7900', \
     keyentry with lines lc rgb '#d55e00' lw 1.2 title '{/:Italic A} = 0.0667, {/:Italic N} = 7900', \
     keyentry with lines lc rgb '#009e73' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 7900', \
     keyentry with lines lc rgb '#cc79a7' lw 1.2 title '{/:Italic A} = 0.1, {/:Italic N} = 7900', \
     $series3 every 1 using 1:2 with lines lc rgb '#cc79a7' lw 1.2 notitle, \
     $series2 every 1 using 1:2 with lines lc rgb '#009e73' lw 1.2 notitle, \
     $series1 every 1 using 1:2 with lines lc rgb '#d55e00' lw 1.2 notitle, \
     $series0 every 1 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle
set output
