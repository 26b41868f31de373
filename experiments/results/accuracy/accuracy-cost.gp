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
set output 'accuracy-cost.svg'
set xlabel 'core-seconds per cycle of 600 sheared grains'
set ylabel 'relative error of the speed after a collision'
set logscale x
set format x '10^{%T}'
set mxtics 10
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.33872706,0.0260712762,,
0.479032402,0.0128341412,,
0.67745412,0.00679596315,,
0.958064804,0.00325726797,,
1.35490824,0.00164428972,,
1.91612961,0.000800483623,,
2.70981648,0.000399496414,,
3.83225922,0.000199513945,,
5.41963296,0.000100515367,,
7.66451844,5.00228832e-05,,
10.8392659,2.50743462e-05,,
EOD
$series1 << EOD
1.35490824,0.0099696747,,
1.91612961,0.00486209556,,
2.70981648,0.0025552862,,
3.83225922,0.001240699,,
5.41963296,0.000624666762,,
7.66451844,0.000316090751,,
10.8392659,0.000157624563,,
15.3290369,7.79118821e-05,,
21.6785318,3.92426198e-05,,
30.6580737,1.94512135e-05,,
43.3570637,9.71546986e-06,,
EOD
$series2 << EOD
1.35490824,0.0108200794,,
1.91612961,0.00512575627,,
2.70981648,0.00266210322,,
3.83225922,0.00129231745,,
5.41963296,0.000652092466,,
7.66451844,0.000327639794,,
10.8392659,0.000163696985,,
15.3290369,8.09542615e-05,,
21.6785318,4.07336727e-05,,
30.6580737,2.0221983e-05,,
43.3570637,1.01203083e-05,,
EOD
$series3 << EOD
7.50240384,0.0260712762,,
10.6100013,0.0128341412,,
15.0048077,0.00679596315,,
21.2200025,0.00325726797,,
30.0096154,0.00164428972,,
42.440005,0.000800483623,,
60.0192307,0.000399496414,,
84.8800101,0.000199513945,,
120.038461,0.000100515367,,
169.76002,5.00228832e-05,,
240.076923,2.50743462e-05,,
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title 'engine', \
     keyentry with linespoints lc rgb '#1f4fd8' lw 1.2 pt 9 ps 0.4 title 'PEFRL', \
     keyentry with linespoints lc rgb '#2ca02c' lw 1.2 pt 11 ps 0.4 title 'Runge-Kutta', \
     keyentry with linespoints lc rgb '#d62728' lw 1.2 pt 5 ps 0.4 title 'LAMMPS', \
     $series3 every 1 using 1:2 with linespoints lc rgb '#d62728' lw 1.2 pt 5 ps 0.4 notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#2ca02c' lw 1.2 pt 11 ps 0.4 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#1f4fd8' lw 1.2 pt 9 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle
set output
