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
0.9,1,,
0.9,0.95,,
4,0.95,,
4,0.9,,
5.04545455,0.9,,
5.04545455,0.85,,
5.6,0.85,,
5.6,0.8,,
6.45454545,0.8,,
6.45454545,0.75,,
20.5714286,0.75,,
20.5714286,0.7,,
23.8181818,0.7,,
23.8181818,0.65,,
27,0.65,,
27,0.6,,
28.7142857,0.6,,
28.7142857,0.55,,
32,0.55,,
32,0.5,,
44.1923077,0.5,,
44.1923077,0.45,,
47,0.45,,
47,0.4,,
49.7142857,0.4,,
49.7142857,0.35,,
49.8888889,0.35,,
49.8888889,0.3,,
61,0.3,,
61,0.25,,
73.3333333,0.25,,
73.3333333,0.2,,
84,0.2,,
84,0.15,,
110,0.15,,
110,0.1,,
113,0.1,,
113,0.05,,
115,0.05,,
115,0,,
115,0,,
EOD
plot keyentry with lines lc rgb '#0072b2' lw 1.2 title '{/:Italic A} = 0.05, {/:Italic N} = 18200', \
     $series0 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle
set output
