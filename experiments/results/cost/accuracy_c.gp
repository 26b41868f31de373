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
set ylabel 'rms error of contacts after 160 ms'
set logscale x
set format x '10^{%T}'
set mxtics 10
set logscale y
unset mytics
set ytics (0.008,0.01,0.012,0.014,0.016,0.018,0.02,0.022,0.024)
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.0178633317,0.0146321564,,0.00124146445
0.0282257082,0.0169705627,,0.00333920815
0.0518288588,0.0134033578,,0.00251758865
0.0984938926,0.0200081234,,0.00417123628
0.189326734,0.0118067777,,0.00267546466
EOD
$series1 << EOD
0.718046193,0.0164385218,,0.00321599023
1.16215829,0.0137903952,,0.0023165209
2.15396982,0.00931262584,,0.00152308456
4.11530226,0.0173407036,,0.00319924339
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 7 ps 0.4 title 'shearcell', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 4 ps 0.4 title 'LAMMPS', \
     $series1 every 1 using 1:($2-$4>0?$2-$4:0.00778954128):(0):($2+$4-($2-$4>0?$2-$4:0.00778954128)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 4 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4>0?$2-$4:0.00778954128):(0):($2+$4-($2-$4>0?$2-$4:0.00778954128)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 7 ps 0.4 notitle
set output
