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
set ytics (10,20,30)
set xrange [*:*]
set yrange [*<13:13<*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from graph 0, first 13 to graph 1, first 13 nohead dt 2 lc rgb '#6a3d9a'
$series0 << EOD
1,32.2208632,,1.13636802
2,28.3834433,,1.02006889
5,23.7268566,,0.968060421
10,19.4523224,,1.08552578
20,15.830742,,1.3666167
40,10.4540125,,1.46663562
EOD
plot keyentry with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.0667', \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#6a3d9a' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 notitle
set output
