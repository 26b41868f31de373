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
0.343504572,0.0260712762,,
0.485788824,0.0128341412,,
0.687009144,0.00679596315,,
0.971577649,0.00325726797,,
1.37401829,0.00164428972,,
1.9431553,0.000800483623,,
2.74803658,0.000399496414,,
3.8863106,0.000199513945,,
5.49607315,0.000100515367,,
7.77262119,5.00228832e-05,,
10.9921463,2.50743462e-05,,
EOD
$series1 << EOD
1.37401829,0.0099696747,,
1.9431553,0.00486209556,,
2.74803658,0.0025552862,,
3.8863106,0.001240699,,
5.49607315,0.000624666762,,
7.77262119,0.000316090751,,
10.9921463,0.000157624563,,
15.5452424,7.79118821e-05,,
21.9842926,3.92426198e-05,,
31.0904848,1.94512135e-05,,
43.9685852,9.71546986e-06,,
EOD
$series2 << EOD
1.37401829,0.0108200794,,
1.9431553,0.00512575627,,
2.74803658,0.00266210322,,
3.8863106,0.00129231745,,
5.49607315,0.000652092466,,
7.77262119,0.000327639794,,
10.9921463,0.000163696985,,
15.5452424,8.09542615e-05,,
21.9842926,4.07336727e-05,,
31.0904848,2.0221983e-05,,
43.9685852,1.01203083e-05,,
EOD
$series3 << EOD
8.09236752,0.0260712762,,
11.4443359,0.0128341412,,
16.184735,0.00679596315,,
22.8886718,0.00325726797,,
32.3694701,0.00164428972,,
45.7773436,0.000800483623,,
64.7389402,0.000399496414,,
91.5546872,0.000199513945,,
129.47788,0.000100515367,,
183.109374,5.00228832e-05,,
258.955761,2.50743462e-05,,
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
