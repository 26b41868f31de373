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
set output 'nucleation_a.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set key maxcols 1 width -4
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'share of runs without an onset'
set ytics 0.2
set format y '%.1f'
set xrange [*:*]
set yrange [0:1]
set offsets graph 0.03, graph 0.03, 0, 0
$series0 << EOD
0,1,,
36.4,1,,
36.4,0.916666667,,
76.6,0.916666667,,
76.6,0.833333333,,
90.1428571,0.833333333,,
90.1428571,0.75,,
125.166667,0.75,,
125.166667,0.666666667,,
218,0.666666667,,
218,0.583333333,,
238,0.583333333,,
238,0.5,,
283.75,0.5,,
283.75,0.416666667,,
292.571429,0.416666667,,
292.571429,0.333333333,,
298.2,0.333333333,,
298.2,0.25,,
300,0.25,,
EOD
$series1 << EOD
0,1,,
24,1,,
24,0.916666667,,
25.1176471,0.916666667,,
25.1176471,0.833333333,,
30.6666667,0.833333333,,
30.6666667,0.75,,
126.375,0.75,,
126.375,0.666666667,,
130,0.666666667,,
130,0.583333333,,
171,0.583333333,,
171,0.5,,
187.4,0.5,,
187.4,0.416666667,,
219.714286,0.416666667,,
219.714286,0.333333333,,
233.666667,0.333333333,,
233.666667,0.25,,
241.714286,0.25,,
241.714286,0.166666667,,
271,0.166666667,,
271,0.0833333333,,
300,0.0833333333,,
EOD
$series2 << EOD
0,1,,
19.5,1,,
19.5,0.875,,
24.3571429,0.875,,
24.3571429,0.75,,
26,0.75,,
26,0.625,,
28,0.625,,
28,0.5,,
48.5,0.5,,
48.5,0.375,,
52,0.375,,
52,0.25,,
134,0.25,,
134,0.125,,
200,0.125,,
EOD
$series3 << EOD
0,1,,
13,1,,
13,0.833333333,,
13.2222222,0.833333333,,
13.2222222,0.666666667,,
13.3333333,0.666666667,,
13.3333333,0.5,,
33,0.5,,
33,0.333333333,,
47,0.333333333,,
47,0.166666667,,
95,0.166666667,,
95,0,,
95,0,,
EOD
plot keyentry with lines lc rgb '#0072b2' lw 1.2 title '{/:Italic A} = 0.05, {/:Italic N} = 5200', \
     keyentry with lines lc rgb '#d55e00' lw 1.2 title '{/:Italic A} = 0.05, {/:Italic N} = 7900', \
     keyentry with lines lc rgb '#009e73' lw 1.2 title '{/:Italic A} = 0.05, {/:Italic N} = 11400', \
     keyentry with lines lc rgb '#cc79a7' lw 1.2 title '{/:Italic A} = 0.05, {/:Italic N} = 18200', \
     $series3 using 1:2 with lines lc rgb '#cc79a7' lw 1.2 notitle, \
     $series2 using 1:2 with lines lc rgb '#009e73' lw 1.2 notitle, \
     $series1 using 1:2 with lines lc rgb '#d55e00' lw 1.2 notitle, \
     $series0 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle
set output
