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
unset mytics
set ytics (2,5,10,20)
set xrange [*:*]
set yrange [*<20:20<*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from graph 0, first 20 to graph 1, first 20 nohead dt 2 lc rgb '#6a3d9a'
$series0 << EOD
1,24.4033914,,1.70331611
2,18.1562681,,1.25031421
5,11.9517521,,1.36192462
10,5.94896692,,1.02833589
20,1.44081837,,0.334372622
EOD
plot keyentry with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.1', \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#6a3d9a' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 notitle
set output
