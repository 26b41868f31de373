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
set output 'accuracy_a.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set key maxcols 3 width -2
set xlabel 'core-seconds per run'
set ylabel 'rms error of {/:Italic ϕ} after 10 ms'
set logscale x
set format x '10^{%T}'
set mxtics 10
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.0178633317,3.48660153e-06,,6.79768005e-07
0.0282257082,2.51211029e-06,,4.24453895e-07
0.0518288588,6.01690084e-07,,1.18231412e-07
0.0984938926,1.43606733e-07,,2.7321539e-08
0.189326734,3.41895419e-08,,6.54230834e-09
EOD
$series1 << EOD
0.718046193,3.48660153e-06,,6.79768005e-07
1.16215829,2.51211029e-06,,4.24453896e-07
2.15396982,6.01690084e-07,,1.18231412e-07
4.11530226,1.43606733e-07,,2.73215391e-08
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 7 ps 0.4 title 'shearcell', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 4 ps 0.4 title 'LAMMPS', \
     $series1 every 1 using 1:($2-$4>0?$2-$4:2.76472336e-08):(0):($2+$4-($2-$4>0?$2-$4:2.76472336e-08)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 4 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4>0?$2-$4:2.76472336e-08):(0):($2+$4-($2-$4>0?$2-$4:2.76472336e-08)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 7 ps 0.4 notitle
set output
