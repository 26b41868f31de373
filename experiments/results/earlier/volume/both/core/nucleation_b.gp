set terminal svg size 325,275 enhanced font 'Helvetica,10.67' background '#ffffff'
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
set output 'nucleation_b.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'onsets per grain and cycle'
set xtics 0.002
set format x '%.3f'
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.643,5.80606345e-06,,3.3521323e-06
0.645,8.26540536e-06,,4.13270268e-06
0.647,4.17498942e-05,,1.25880668e-05
0.649,7.9554752e-05,,2.81268523e-05
0.651,3.3774608e-05,,2.38822543e-05
0.655,2.84109742e-05,,
EOD
$series1 << EOD
0.643,3.15115911e-06,,1.81932256e-06
0.645,3.36402197e-05,,7.71759569e-06
0.647,4.88074356e-05,,1.84474767e-05
0.649,5.77547665e-05,,
EOD
$series2 << EOD
0.641,1.78075138e-06,,
0.643,1.11727745e-05,,3.22530217e-06
0.645,2.35753425e-05,,6.80561517e-06
0.647,4.25221193e-05,,1.90164699e-05
EOD
$series3 << EOD
0.639,1.42808302e-06,,
0.641,2.67528446e-06,,1.54457621e-06
0.643,1.00900369e-05,,2.3782445e-06
0.645,2.28478442e-05,,8.6356734e-06
0.647,0.000194664744,,
EOD
plot keyentry with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.0833, {/:Italic N} = 2000', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.0833, {/:Italic N} = 5200', \
     keyentry with points lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 title '{/:Italic A} = 0.0833, {/:Italic N} = 7900', \
     keyentry with points lc rgb '#cc79a7' lw 1.2 pt 11 ps 0.4 title '{/:Italic A} = 0.0833, {/:Italic N} = 18200', \
     $series3 every 1 using 1:2:4 with yerrorbars lc rgb '#cc79a7' lw 0.7 pt 0 notitle, \
     $series3 every 1 using 1:2 with points lc rgb '#cc79a7' lw 1.2 pt 11 ps 0.4 notitle, \
     $series2 every 1 using 1:2:4 with yerrorbars lc rgb '#009e73' lw 0.7 pt 0 notitle, \
     $series2 every 1 using 1:2 with points lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 notitle, \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#d55e00' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#0072b2' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
