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
set output 'S6_crystalline.svg'
set label '(c)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'percentage crystalline  [%]'
set xtics 0.002
set format x '%.3f'
set ytics 0.05
set format y '%.2f'
set xrange [*:*]
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
set arrow from 0.645, graph 0 to 0.645, graph 1 nohead dt 2 lc rgb '#888888'
set arrow from 0.647, graph 0 to 0.647, graph 1 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.637626936,0.0181620051,,
0.639026719,0.0281552907,7.90757288e-05,0.00629853848
0.641189349,0.0379611262,7.33517251e-05,0.00711371496
0.643196496,0.0477512863,3.69207526e-05,0.00952810712
0.645100116,0.0853385769,0.000106082504,0.0126111132
0.646467249,0.131819738,0.000116787062,0.0272194638
0.648107174,0.141764583,,
EOD
$series1 << EOD
0.639214617,0.0266068328,8.47893771e-05,0.00508273038
0.641173288,0.0310889149,6.46063844e-05,0.0045898962
0.643159675,0.0453594336,5.84412669e-05,0.00457165178
0.645052782,0.081378345,0.000103867978,0.0148711446
0.646587962,0.0910566929,8.60929802e-05,0.0155572771
0.648418294,0.180022137,,
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.05, gravity', \
     keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 4 ps 0.4 title '{/:Italic A} = 0.05, no gravity', \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 4 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
