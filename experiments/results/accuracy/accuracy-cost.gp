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
0.335970084,0.0259611708,,
0.475133449,0.0128415041,,
0.671940168,0.00679537881,,
0.950266899,0.00323422336,,
1.34388034,0.00164769311,,
1.9005338,0.00080944317,,
2.68776067,0.000401094857,,
3.80106759,0.000201580683,,
5.37552134,0.000101713993,,
7.60213519,5.02735476e-05,,
10.7510427,2.53517512e-05,,
EOD
$series1 << EOD
1.34388034,0.00993178525,,
1.9005338,0.00495630392,,
2.68776067,0.00255355663,,
3.80106759,0.00126536539,,
5.37552134,0.000641339367,,
7.60213519,0.000316915998,,
10.7510427,0.000158068107,,
15.2042704,7.92737675e-05,,
21.5020854,3.96746774e-05,,
30.4085408,1.98270824e-05,,
43.0041708,9.96399252e-06,,
EOD
$series2 << EOD
1.34388034,0.0109041401,,
1.9005338,0.00516236973,,
2.68776067,0.0026602664,,
3.80106759,0.00131255053,,
5.37552134,0.000667974199,,
7.60213519,0.000329744944,,
10.7510427,0.000163885737,,
15.2042704,8.2554447e-05,,
21.5020854,4.11467538e-05,,
30.4085408,2.05445122e-05,,
43.0041708,1.03737817e-05,,
EOD
$series3 << EOD
7.76611092,0.0259611708,,
10.9829394,0.0128415041,,
15.5322218,0.00679537881,,
21.9658788,0.00323422336,,
31.0644437,0.00164769311,,
43.9317576,0.00080944317,,
62.1288874,0.000401094857,,
87.8635151,0.000201580683,,
124.257775,0.000101713993,,
175.72703,5.02735476e-05,,
248.515549,2.53517512e-05,,
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
