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
0.643,6.50348661e-06,,
0.645,8.37340005e-06,,
0.647,3.2811882e-05,,1.89439489e-05
0.649,9.80666721e-05,,4.90333361e-05
EOD
$series1 << EOD
0.643,2.79886019e-06,,
0.645,2.00613904e-05,,8.97172655e-06
0.647,3.51951965e-05,,2.03199562e-05
0.649,9.4691695e-05,,
EOD
$series2 << EOD
0.643,4.79474276e-06,,3.39039512e-06
0.645,1.9138268e-05,,8.55889364e-06
0.647,3.23325357e-05,,1.86671982e-05
EOD
$series3 << EOD
0.639,4.99926511e-06,,
0.641,5.04918712e-06,,3.57031445e-06
0.643,1.18905543e-05,,5.94527713e-06
0.645,3.07579815e-05,,1.77581289e-05
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
