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
0.645,3.45592038e-05,,
0.649,6.38961985e-05,,4.51814352e-05
0.651,0.000129954016,,7.50289858e-05
0.653,0.000261083631,,0.000130541815
0.655,0.000198291857,,0.000140213517
0.657,0.000424778761,,0.000300363942
0.659,0.000320114488,,
0.661,0.000747943156,,
0.663,0.00321543408,,
0.665,0.00657013183,,0.00464578477
0.667,0.0158940397,,
EOD
$series1 << EOD
0.647,6.74345133e-05,,2.38417008e-05
0.649,0.000130900783,,4.62804156e-05
0.651,0.000202527889,,0.000116929531
0.657,0.000269966254,,
EOD
$series2 << EOD
0.643,1.52258447e-05,,8.79064553e-06
0.645,1.71753648e-05,,8.58768242e-06
0.647,7.2462875e-05,,2.41542917e-05
0.649,0.000156893893,,7.84469463e-05
EOD
$series3 << EOD
0.643,3.00810038e-06,,2.12704818e-06
0.645,2.4304234e-05,,6.27532624e-06
0.647,5.45634357e-05,,3.15022143e-05
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
