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
set bars 0.5
set output 'S6_onset.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set xlabel 'amplitude  {/:Italic A}  [rad]'
set ylabel 'onset  {/:Italic ϕ}'
set xtics 0.02
set format x '%.2f'
set ytics 0.0005
set format y '%.4f'
set xrange [0:0.12]
set yrange [*<0.6445:0.6475<*]
set offsets 0, 0, graph 0.05, graph 0.05
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#888888'
set arrow from graph 0, first 0.647 to graph 1, first 0.647 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.04,0.645015439,,0.00121821809
0.05,0.645129441,,0.000874644227
EOD
$series1 << EOD
0.04,0.645695894,,0.000890166877
0.05,0.64561933,,0.000771970091
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'gravity', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title 'no gravity', \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#d55e00' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
