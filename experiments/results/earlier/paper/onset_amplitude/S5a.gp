set terminal svg size 325,260 enhanced font 'Helvetica,10.67' background '#ffffff'
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
set output 'S5a.svg'
set xlabel 'amplitude  {/:Italic A}  [rad]'
set ylabel 'onset  {/:Italic ϕ}'
set xtics 0.02
set format x '%.2f'
set ytics 0.002
set format y '%.3f'
set xrange [0:0.12]
set yrange [*<0.6445:0.6475<*]
set offsets 0, 0, graph 0.05, graph 0.05
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#888888'
set arrow from graph 0, first 0.647 to graph 1, first 0.647 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.01,0.645,,0.00109410183
EOD
$series1 << EOD
0.05,0.645570343,,0.000457265353
0.0667,0.64656169,,0.000720283698
0.0833,0.646089051,,0.000665802448
0.1,0.642727418,,0.000409511642
EOD
$series2 << EOD
0.051,0.645670238,,0.00112397059
0.0677,0.648045238,,0.000625822897
0.0843,0.647545238,,0.000864358892
0.101,0.641976753,,0.000831181712
EOD
plot keyentry with points lc rgb '#e69f00' lw 1.2 pt 7 ps 0.4 title 'experiment', \
     keyentry with points lc rgb '#0072b2' lw 1.2 pt 9 ps 0.4 title 'largest crystallite is critical', \
     keyentry with points lc rgb '#009e73' lw 1.2 pt 13 ps 0.4 title 'steepest growth', \
     $series2 every 1 using 1:2:4 with yerrorbars lc rgb '#009e73' lw 0.7 pt 0 notitle, \
     $series2 every 1 using 1:2 with points lc rgb '#009e73' lw 1.2 pt 13 ps 0.4 notitle, \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#0072b2' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 9 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#e69f00' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#e69f00' lw 1.2 pt 7 ps 0.4 notitle
set output
