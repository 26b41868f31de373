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
set output 'accuracy-cost.svg'
set key maxcols 2 width -2
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
0.074879304,0.0259611708,,
0.105895327,0.0128415041,,
0.149758608,0.00679537881,,
0.211790655,0.00323422336,,
0.299517216,0.00164769311,,
0.423581309,0.00080944317,,
0.599034432,0.000401094857,,
0.847162618,0.000201580683,,
1.19806886,0.000101713993,,
1.69432524,5.02735476e-05,,
2.39613773,2.53517512e-05,,
EOD
$series1 << EOD
0.299517216,0.00993178525,,
0.423581309,0.00495630392,,
0.599034432,0.00255355663,,
0.847162618,0.00126536539,,
1.19806886,0.000641339367,,
1.69432524,0.000316915998,,
2.39613773,0.000158068107,,
3.38865047,7.92737675e-05,,
4.79227546,3.96746774e-05,,
6.77730094,1.98270824e-05,,
9.58455091,9.96399252e-06,,
EOD
$series2 << EOD
0.299517216,0.0109041401,,
0.423581309,0.00516236973,,
0.599034432,0.0026602664,,
0.847162618,0.00131255053,,
1.19806886,0.000667974199,,
1.69432524,0.000329744944,,
2.39613773,0.000163885737,,
3.38865047,8.2554447e-05,,
4.79227546,4.11467538e-05,,
6.77730094,2.05445122e-05,,
9.58455091,1.03737817e-05,,
EOD
$series3 << EOD
3.41388048,0.0259611708,,
4.82795608,0.0128415041,,
6.82776096,0.00679537881,,
9.65591215,0.00323422336,,
13.6555219,0.00164769311,,
19.3118243,0.00080944317,,
27.3110438,0.000401094857,,
38.6236486,0.000201580683,,
54.6220877,0.000101713993,,
77.2472972,5.02735476e-05,,
109.244175,2.53517512e-05,,
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
