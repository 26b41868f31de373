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
set output 'S6_onset.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set key maxcols 1 width -7
set xlabel 'amplitude {/:Italic A} [rad]'
set ylabel 'onset {/:Italic ϕ}'
set xtics 0.002
set format x '%.3f'
set ytics 0.001
set format y '%.3f'
set xrange [*:*]
set yrange [0.644728408:0.649317323]
set offsets graph 0.03, graph 0.03, 0, 0
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#000000'
set arrow from graph 0, first 0.647 to graph 1, first 0.647 nohead dt 2 lc rgb '#000000'
$series0 << EOD
0.04,0.645606733,,0.000669738573
0.05,0.64660154,,0.000359838519
EOD
$series1 << EOD
0.04,0.647069089,,0.00203964783
0.05,0.646449837,,0.000314596568
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title 'gravity (6 to 12 runs)', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title 'no gravity (4 to 12 runs)', \
     keyentry with lines lc rgb '#000000' lw 1.2 dt 2 title 'the supplement 0.646 ± 0.001', \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
