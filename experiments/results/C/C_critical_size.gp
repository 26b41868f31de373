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
set output 'C_critical_size.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set key maxcols 1 width -6
set xlabel 'amplitude  {/:Italic A}  [rad]'
set ylabel 'critical size  [grains]'
set xtics 0.02
set format x '%.2f'
set ytics 5
set format y '%.0f'
set xrange [0:0.12]
set yrange [*:*]
set offsets 0, 0, graph 0.05, graph 0.05
$series0 << EOD
0.04,10,,
0.05,10,,
0.0667,13,,
0.0833,16,,
0.1,20,,
EOD
$series1 << EOD
0.05,2.31468466,,5.2840233
0.0667,7.07419967,,2.31776305
0.0833,8.9072644,,2.41140476
0.1,25.3343502,,3.79479167
EOD
plot keyentry with linespoints lc rgb '#888888' lw 1.2 dt 2 pt 6 ps 0.4 title 'supplement', \
     keyentry with points lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'simulated (6 to 40 runs)', \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#888888' lw 1.2 dt 2 pt 6 ps 0.4 notitle
set output
