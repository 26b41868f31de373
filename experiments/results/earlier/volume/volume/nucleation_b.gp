set terminal svg size 325,335 enhanced font 'Helvetica,10.67' background '#ffffff'
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
set xtics 0.005
set format x '%.3f'
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.653,0.000894774517,,
0.657,0.00439602446,,
EOD
$series1 << EOD
0.643,8.44097869e-06,,
0.647,2.56671886e-05,,1.81494431e-05
0.649,0.000110835758,,6.3991055e-05
EOD
$series2 << EOD
0.643,4.71088587e-06,,
0.645,1.80600668e-05,,1.04269844e-05
0.647,5.56013752e-05,,3.93161095e-05
EOD
$series3 << EOD
0.643,3.91804392e-06,,
0.645,1.06561694e-05,,7.53504966e-06
0.647,3.23325357e-05,,1.86671982e-05
EOD
$series4 << EOD
0.639,8.5732118e-06,,
0.641,9.27448644e-06,,6.55805225e-06
0.643,5.98648904e-06,,
0.645,2.19214718e-05,,1.55008214e-05
EOD
$series5 << EOD
0.643,2.43994324e-05,,1.72530041e-05
0.645,0.000140764313,,7.03821566e-05
EOD
$series6 << EOD
0.641,5.51880666e-06,,
0.643,6.33721772e-05,,2.83408992e-05
EOD
$series7 << EOD
0.641,1.86408996e-05,,8.33646372e-06
0.643,0.000216309756,,
EOD
plot keyentry with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.0833, {/:Italic N} = 1000', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.0833, {/:Italic N} = 2000', \
     keyentry with points lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 title '{/:Italic A} = 0.0833, {/:Italic N} = 5200', \
     keyentry with points lc rgb '#cc79a7' lw 1.2 pt 11 ps 0.4 title '{/:Italic A} = 0.0833, {/:Italic N} = 7900', \
     keyentry with points lc rgb '#e69f00' lw 1.2 pt 13 ps 0.4 title '{/:Italic A} = 0.0833, {/:Italic N} = 18200', \
     keyentry with points lc rgb '#56b4e9' lw 1.2 pt 4 ps 0.4 title '{/:Italic A} = 0.1, {/:Italic N} = 5200', \
     keyentry with points lc rgb '#000000' lw 1.2 pt 6 ps 0.4 title '{/:Italic A} = 0.1, {/:Italic N} = 7900', \
     keyentry with points lc rgb '#0072b2' lw 1.2 pt 8 ps 0.4 title '{/:Italic A} = 0.1, {/:Italic N} = 18200', \
     $series7 every 1 using 1:2:4 with yerrorbars lc rgb '#0072b2' lw 0.7 pt 0 notitle, \
     $series7 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 8 ps 0.4 notitle, \
     $series6 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series6 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 6 ps 0.4 notitle, \
     $series5 every 1 using 1:2:4 with yerrorbars lc rgb '#56b4e9' lw 0.7 pt 0 notitle, \
     $series5 every 1 using 1:2 with points lc rgb '#56b4e9' lw 1.2 pt 4 ps 0.4 notitle, \
     $series4 every 1 using 1:2:4 with yerrorbars lc rgb '#e69f00' lw 0.7 pt 0 notitle, \
     $series4 every 1 using 1:2 with points lc rgb '#e69f00' lw 1.2 pt 13 ps 0.4 notitle, \
     $series3 every 1 using 1:2:4 with yerrorbars lc rgb '#cc79a7' lw 0.7 pt 0 notitle, \
     $series3 every 1 using 1:2 with points lc rgb '#cc79a7' lw 1.2 pt 11 ps 0.4 notitle, \
     $series2 every 1 using 1:2:4 with yerrorbars lc rgb '#009e73' lw 0.7 pt 0 notitle, \
     $series2 every 1 using 1:2 with points lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 notitle, \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#d55e00' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
