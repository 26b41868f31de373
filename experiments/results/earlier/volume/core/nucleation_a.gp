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
12.6,1,,
12.6,0.9,,
22.2692308,0.9,,
22.2692308,0.8,,
30.8,0.8,,
30.8,0.7,,
60.1325301,0.7,,
60.1325301,0.6,,
60.8333333,0.6,,
60.8333333,0.5,,
63,0.5,,
63,0.4,,
69.9375,0.4,,
69.9375,0.3,,
74,0.3,,
74,0.2,,
110.052632,0.2,,
110.052632,0.1,,
150,0.1,,
EOD
$series1 << EOD
0,1,,
13.8571429,1,,
13.8571429,0.9,,
17.9,0.9,,
17.9,0.8,,
20.625,0.8,,
20.625,0.7,,
21.5714286,0.7,,
21.5714286,0.6,,
28.6666667,0.6,,
28.6666667,0.5,,
30,0.5,,
30,0.4,,
32.5555556,0.4,,
32.5555556,0.3,,
32.7333333,0.3,,
32.7333333,0.2,,
37.1176471,0.2,,
37.1176471,0.1,,
38,0.1,,
38,0,,
38,0,,
EOD
$series2 << EOD
0,1,,
12.625,1,,
12.625,0.9,,
12.6363636,0.9,,
12.6363636,0.8,,
12.7,0.8,,
12.7,0.7,,
18.2666667,0.7,,
18.2666667,0.6,,
19.0833333,0.6,,
19.0833333,0.5,,
21.2592593,0.5,,
21.2592593,0.4,,
21.5555556,0.4,,
21.5555556,0.3,,
23.6428571,0.3,,
23.6428571,0.2,,
27,0.2,,
27,0.1,,
28.3529412,0.1,,
28.3529412,0,,
28.3529412,0,,
EOD
$series3 << EOD
0,1,,
0.4,1,,
0.4,0.9,,
4,0.9,,
4,0.8,,
5.54545455,0.8,,
5.54545455,0.7,,
5.66666667,0.7,,
5.66666667,0.6,,
6.25806452,0.6,,
6.25806452,0.5,,
7.04545455,0.5,,
7.04545455,0.4,,
7.28571429,0.4,,
7.28571429,0.3,,
12.1666667,0.3,,
12.1666667,0.2,,
12.4545455,0.2,,
12.4545455,0.1,,
13.4166667,0.1,,
13.4166667,0,,
13.4166667,0,,
EOD
plot keyentry with lines lc rgb '#0072b2' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 2000', \
     keyentry with lines lc rgb '#d55e00' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 5200', \
     keyentry with lines lc rgb '#009e73' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 7900', \
     keyentry with lines lc rgb '#cc79a7' lw 1.2 title '{/:Italic A} = 0.0833, {/:Italic N} = 18200', \
     $series3 using 1:2 with lines lc rgb '#cc79a7' lw 1.2 notitle, \
     $series2 using 1:2 with lines lc rgb '#009e73' lw 1.2 notitle, \
     $series1 using 1:2 with lines lc rgb '#d55e00' lw 1.2 notitle, \
     $series0 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle
set output
