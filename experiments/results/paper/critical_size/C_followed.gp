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
set output 'C_followed.svg'
data = 'C_followed.csv'
set label '(d)' at screen 0.015, screen 0.96 left front
set xlabel 'cycles that crystallites are followed'
set ylabel 'critical size  [grains]'
set logscale x
set format x '10^{%T}'
set mxtics 10
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*<11.25:21.75<*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from graph 0, first 13 to graph 1, first 13 nohead dt 2 lc rgb '#6a3d9a'
set arrow from graph 0, first 16 to graph 1, first 16 nohead dt 2 lc rgb '#000000'
set arrow from graph 0, first 20 to graph 1, first 20 nohead dt 2 lc rgb '#009e73'
$series0 << EOD
1,34.1214284,,3.63192128
2,30.1806244,,5.88572757
5,21.6847348,,4.15767102
10,17.5843762,,3.87904224
20,12.8349037,,5.01382699
40,10.1332401,,4.13072199
EOD
$series1 << EOD
1,24.5121048,,7.12586966
2,19.7757173,,3.90974644
5,15.7729618,,9.023386
10,9.10916258,,6.10013597
15,4.00012465,,1.05265134
20,3.02413579,,0.756028199
EOD
$series2 << EOD
1,15.7191717,,2.02528008
2,12.0737717,,1.26404499
5,7.06568972,,3.25633436
10,4.59580755,,2.31844142
EOD
plot keyentry with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.0667', \
     keyentry with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.0833', \
     keyentry with linespoints lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 title '{/:Italic A} = 0.1', \
     $series2 every 1 using 1:2:4 with yerrorbars lc rgb '#009e73' lw 0.7 pt 0 notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 notitle, \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#6a3d9a' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 notitle
set output
