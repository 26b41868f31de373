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
set output 'accuracy_b.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set key maxcols 3 width -2
set xlabel 'core-seconds per run'
set ylabel 'rms error of {/:Italic ϕ} after 160 ms'
set logscale x
set format x '10^{%T}'
set mxtics 10
set logscale y
unset mytics
set ytics (5e-05,0.0001)
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.0178633317,0.000135821427,,5.47965455e-05
0.0282257082,5.98140081e-05,,1.82294973e-05
0.0518288588,0.00012098862,,5.46065419e-05
0.0984938926,8.48091559e-05,,3.34954126e-05
0.189326734,5.3533923e-05,,1.2696586e-05
EOD
$series1 << EOD
0.718046193,0.000111330373,,4.4766148e-05
1.16215829,7.43207388e-05,,2.86684241e-05
2.15396982,0.000116389404,,4.99619657e-05
4.11530226,9.49738749e-05,,3.94026855e-05
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 7 ps 0.4 title 'shearcell', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 4 ps 0.4 title 'LAMMPS', \
     $series1 every 1 using 1:($2-$4>0?$2-$4:4.0837337e-05):(0):($2+$4-($2-$4>0?$2-$4:4.0837337e-05)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 4 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4>0?$2-$4:4.0837337e-05):(0):($2+$4-($2-$4>0?$2-$4:4.0837337e-05)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 7 ps 0.4 notitle
set output
