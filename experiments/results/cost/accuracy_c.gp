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
set output 'accuracy_c.svg'
set label '(c)' at screen 0.015, screen 0.96 left front
set key maxcols 3 width -2
set xlabel 'core-seconds per run'
set ylabel 'rms error of contacts per grain after 160 ms'
set logscale x
set format x '10^{%T}'
set mxtics 10
set logscale y
unset mytics
set ytics (0.01,0.02,0.03)
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.0719876878,0.0146321564,,0.00124146445
0.126917864,0.0169705627,,0.00333920815
0.227656151,0.0134033578,,0.00251758865
0.451732132,0.0200081234,,0.00417123628
0.833373666,0.0118067777,,0.00267546466
EOD
$series1 << EOD
1.78214621,0.0143361431,,0.00257131206
2.95655794,0.0175591856,,0.00253902974
6.01653467,0.0103307793,,0.00134258383
11.5909703,0.0232212187,,0.0072280274
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 7 ps 0.4 title 'shearcell', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 4 ps 0.4 title 'LAMMPS', \
     $series1 every 1 using 1:($2-$4>0?$2-$4:0.00898819543):(0):($2+$4-($2-$4>0?$2-$4:0.00898819543)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 4 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4>0?$2-$4:0.00898819543):(0):($2+$4-($2-$4>0?$2-$4:0.00898819543)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 7 ps 0.4 notitle
set output
