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
3.21246438,0.0260712762,,
4.5431107,0.0128341412,,
6.42492876,0.00679596315,,
9.08622139,0.00325726797,,
12.8498575,0.00164428972,,
18.1724428,0.000800483623,,
25.6997151,0.000399496414,,
36.3448856,0.000199513945,,
51.3994301,0.000100515367,,
72.6897712,5.00228832e-05,,
102.79886,2.50743462e-05,,
EOD
$series1 << EOD
12.8498575,0.0099696747,,
18.1724428,0.00486209556,,
25.6997151,0.0025552862,,
36.3448856,0.001240699,,
51.3994301,0.000624666762,,
72.6897712,0.000316090751,,
102.79886,0.000157624563,,
145.379542,7.79118821e-05,,
205.59772,3.92426198e-05,,
290.759085,1.94512135e-05,,
411.195441,9.71546986e-06,,
EOD
$series2 << EOD
12.8498575,0.0108200794,,
18.1724428,0.00512575627,,
25.6997151,0.00266210322,,
36.3448856,0.00129231745,,
51.3994301,0.000652092466,,
72.6897712,0.000327639794,,
102.79886,0.000163696985,,
145.379542,8.09542615e-05,,
205.59772,4.07336727e-05,,
290.759085,2.0221983e-05,,
411.195441,1.01203083e-05,,
EOD
$series3 << EOD
69.2158022,0.0260712762,,
97.8859262,0.0128341412,,
138.431604,0.00679596315,,
195.771852,0.00325726797,,
276.863209,0.00164428972,,
391.543705,0.000800483623,,
553.726417,0.000399496414,,
783.087409,0.000199513945,,
1107.45283,0.000100515367,,
1566.17482,5.00228832e-05,,
2214.90567,2.50743462e-05,,
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
