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
0.0719876878,0.000135821427,,5.47965455e-05
0.126917864,5.98140081e-05,,1.82294973e-05
0.227656151,0.00012098862,,5.46065419e-05
0.451732132,8.48091559e-05,,3.34954126e-05
0.833373666,5.3533923e-05,,1.2696586e-05
EOD
$series1 << EOD
1.78214621,0.000138563988,,6.03727112e-05
2.95655794,7.50826111e-05,,2.71773513e-05
6.01653467,0.000115716113,,5.20029077e-05
11.5909703,9.2030493e-05,,3.59854947e-05
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 7 ps 0.4 title 'shearcell', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 4 ps 0.4 title 'LAMMPS', \
     $series1 every 1 using 1:($2-$4>0?$2-$4:4.0837337e-05):(0):($2+$4-($2-$4>0?$2-$4:4.0837337e-05)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 4 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4>0?$2-$4:4.0837337e-05):(0):($2+$4-($2-$4>0?$2-$4:4.0837337e-05)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 7 ps 0.4 notitle
set output
