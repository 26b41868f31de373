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
set output 'nucleation_core.svg'
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'onsets per grain and cycle'
set xtics 0.005
set format x '%.3f'
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.649,0.000126151129,,
0.651,0.000112737453,,
0.655,0.000435949484,,0.000308262837
0.657,0.000305660614,,
0.661,0.000866906967,,0.000612995795
0.663,0.000536691093,,
0.665,0.000465766185,,
EOD
$series1 << EOD
0.647,1.18056785e-05,,
0.649,0.000121512617,,5.43420943e-05
0.651,8.6048607e-05,,4.96801864e-05
0.653,0.000191103567,,
EOD
$series2 << EOD
0.645,6.25383438e-06,,
0.647,5.83087446e-05,,2.60764633e-05
0.649,1.87202686e-05,,
0.651,9.19416433e-05,,6.50125595e-05
0.653,0.00112523167,,
EOD
$series3 << EOD
0.641,6.22630889e-06,,
0.643,1.09504613e-05,,6.3222518e-06
0.645,2.68671877e-05,,1.34335938e-05
0.647,6.75133972e-05,,4.7739181e-05
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
