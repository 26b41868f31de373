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
set output 'summary_a.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set key maxcols 1 width -7
set xlabel 'amplitude {/:Italic A} [rad]'
set ylabel 'onset {/:Italic ϕ}'
set xtics 0.01
set format x '%.2f'
set ytics 0.001
set format y '%.3f'
set xrange [*:*]
set yrange [0.642377957:0.648581445]
set offsets graph 0.03, graph 0.03, 0, 0
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#000000'
set arrow from graph 0, first 0.647 to graph 1, first 0.647 nohead dt 2 lc rgb '#000000'
$series0 << EOD
0.04,0.645606733,,0.000669738573
0.05,0.64660154,,0.000359838519
0.0667,0.646482973,,0.000429329416
0.0833,0.646271399,,0.000484822094
0.1,0.643185255,,0.000525321205
EOD
$series1 << EOD
0.041,0.646394521,,0.00188161795
0.051,0.647114232,,0.000784670959
0.0677,0.647555914,,0.000743555013
0.0843,0.646462164,,0.000570393623
0.101,0.644301191,,0.000514944877
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 9 ps 0.4 title 'largest crystallite is critical', \
     keyentry with linespoints lc rgb '#009e73' lw 1.2 pt 13 ps 0.4 title 'steepest growth', \
     keyentry with lines lc rgb '#000000' lw 1.2 dt 2 title 'the supplement 0.646 ± 0.001', \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#009e73' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#009e73' lw 1.2 pt 13 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 9 ps 0.4 notitle
set output
