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
set output 'committor_sizes.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set key maxcols 3 width -2
set xlabel 'cycles without a descendant'
set ylabel 'crystallite size at which half grow  [grains]'
set xtics 1
unset mxtics
set ytics 5
set format y '%.0f'
set xrange [0.5:3.5]
set yrange [0:25]
set offsets 0, 0, 0, 0
set arrow from graph 0, first 10 to graph 1, first 10 nohead dt 2 lc rgb '#000000'
set arrow from graph 0, first 13 to graph 1, first 13 nohead dt 2 lc rgb '#009e73'
set arrow from graph 0, first 16 to graph 1, first 16 nohead dt 2 lc rgb '#0072b2'
set arrow from graph 0, first 20 to graph 1, first 20 nohead dt 2 lc rgb '#d55e00'
$series1 << EOD
1.04,11.9273505,,
2.04,10.9140187,,1.18993659
3.04,10.3165419,,0.87713305
EOD
$series2 << EOD
1.08,7.48812296,,0.958433831
2.08,6.95107529,,0.573321962
3.08,6.77343115,,0.820792309
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.05', \
     keyentry with linespoints lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 title '{/:Italic A} = 0.0667', \
     keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 title '{/:Italic A} = 0.0833', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 13 ps 0.4 title '{/:Italic A} = 0.1', \
     $series2 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 notitle, \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#009e73' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 notitle
set output
