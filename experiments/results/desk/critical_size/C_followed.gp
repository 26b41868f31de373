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
set output 'C_followed.svg'
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
set yrange [*<15:21<*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from graph 0, first 16 to graph 1, first 16 nohead dt 2 lc rgb '#6a3d9a'
set arrow from graph 0, first 20 to graph 1, first 20 nohead dt 2 lc rgb '#000000'
$series0 << EOD
1,31.4760086,,6.47091398
2,20.9007467,,6.60071063
5,10.7551345,,3.52632231
10,4.91485622,,1.84856629
15,2.28659674,,0.797054271
20,1.47388989,,0.538745043
EOD
$series1 << EOD
1,13.9606561,,4.40155758
2,13.4318112,,3.78757733
5,7.33469152,,2.49344923
EOD
plot keyentry with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.0833', \
     keyentry with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.1', \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#6a3d9a' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 notitle
set output
