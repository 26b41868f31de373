set terminal svg size 325,335 enhanced font 'Helvetica,10.67' background '#ffffff'
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
$series3 << EOD
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
$series4 << EOD
0,1,,
0.4,1,,
0.4,0.833333333,,
4,0.833333333,,
4,0.666666667,,
5.54545455,0.666666667,,
5.54545455,0.5,,
7.04545455,0.5,,
7.04545455,0.333333333,,
12.1666667,0.333333333,,
12.1666667,0.166666667,,
13.4166667,0.166666667,,
13.4166667,0,,
13.4166667,0,,
EOD
$series5 << EOD
0,1,,
5.10204082,1,,
5.10204082,0.833333333,,
11.1692308,0.833333333,,
11.1692308,0.666666667,,
14.22,0.666666667,,
14.22,0.5,,
15.6,0.5,,
15.6,0.333333333,,
18.3529412,0.333333333,,
18.3529412,0.166666667,,
23.2380952,0.166666667,,
23.2380952,0,,
23.2380952,0,,
EOD
$series6 << EOD
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
$series7 << EOD
0,1,,
2.83333333,1,,
2.83333333,0.833333333,,
3.40740741,0.833333333,,
3.40740741,0.666666667,,
6.23529412,0.666666667,,
6.23529412,0.5,,
6.33333333,0.5,,
6.33333333,0.333333333,,
6.45454545,0.333333333,,
6.45454545,0.166666667,,
7.4137931,0.166666667,,
7.4137931,0,,
7.4137931,0,,
EOD
plot keyentry with lines lc rgb '#0072b2' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 1000', \
     keyentry with lines lc rgb '#d55e00' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 2000', \
     keyentry with lines lc rgb '#009e73' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 5200', \
     keyentry with lines lc rgb '#cc79a7' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 7900', \
     keyentry with lines lc rgb '#e69f00' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 18200', \
     keyentry with lines lc rgb '#56b4e9' lw 1.2 title '{/:Italic A} = 0.1, {/:Italic N} = 5200', \
     keyentry with lines lc rgb '#000000' lw 1.2 title '{/:Italic A} = 0.1, {/:Italic N} = 7900', \
     keyentry with lines lc rgb '#0072b2' lw 1.2 title '{/:Italic A} = 0.1, {/:Italic N} = 18200', \
     $series7 every 1 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle, \
     $series6 every 1 using 1:2 with lines lc rgb '#000000' lw 1.2 notitle, \
     $series5 every 1 using 1:2 with lines lc rgb '#56b4e9' lw 1.2 notitle, \
     $series4 every 1 using 1:2 with lines lc rgb '#e69f00' lw 1.2 notitle, \
     $series3 every 1 using 1:2 with lines lc rgb '#cc79a7' lw 1.2 notitle, \
     $series2 every 1 using 1:2 with lines lc rgb '#009e73' lw 1.2 notitle, \
     $series1 every 1 using 1:2 with lines lc rgb '#d55e00' lw 1.2 notitle, \
     $series0 every 1 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle
set output
