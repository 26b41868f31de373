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
set bars 0.5
set output 'S6_contacts.svg'
set label '(d)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'contacts per grain'
set xtics 0.002
set format x '%.3f'
set ytics 0.05
set format y '%.2f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from 0.645, graph 0 to 0.645, graph 1 nohead dt 2 lc rgb '#888888'
set arrow from 0.647, graph 0 to 0.647, graph 1 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.637626936,6.61101266,,
0.639026719,6.57959388,7.90757288e-05,0.0188832373
0.641189349,6.48004307,7.33517251e-05,0.00628097053
0.643196496,6.50946949,3.69207526e-05,0.00363609929
0.645100116,6.52492403,0.000106082504,0.00510432113
0.646467249,6.52425194,0.000116787062,0.00787832389
0.648107174,6.53682278,,
EOD
$series1 << EOD
0.639214617,6.43115506,8.47893771e-05,0.0148215193
0.641173288,6.32823576,6.46063844e-05,0.00535504149
0.643159675,6.34244935,5.84412669e-05,0.00327349344
0.645052782,6.35358414,0.000103867978,0.00312019529
0.646587962,6.35246908,8.60929802e-05,0.00179655124
0.648418294,6.35324274,,
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.05, gravity', \
     keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 4 ps 0.4 title '{/:Italic A} = 0.05, no gravity', \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 4 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
