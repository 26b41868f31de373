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
0.645,2.34880442e-05,,
0.649,7.64764414e-05,,4.4153694e-05
0.651,0.000125175028,,6.25875139e-05
0.653,0.000200714933,,0.000100357466
0.655,0.000272594129,,0.000136297064
0.657,0.000375942877,,0.000217050721
0.659,0.000196121411,,
0.661,0.00082325924,,0.000475308944
0.663,0.000919849286,,0.000650431668
0.665,0.00122378655,,0.000706553492
0.667,0.00151076419,,
EOD
$series1 << EOD
0.647,4.42611457e-05,,1.47537152e-05
0.649,0.000127123226,,3.52576393e-05
0.651,0.000120780749,,4.93085345e-05
0.653,0.000110659072,,
0.657,0.000269966254,,
EOD
$series2 << EOD
0.643,9.52400897e-06,,5.49868914e-06
0.645,1.27293315e-05,,5.6927301e-06
0.647,6.66819203e-05,,1.78214928e-05
0.649,6.33609368e-05,,2.83358724e-05
0.651,9.19416433e-05,,6.50125595e-05
0.653,0.00112523167,,
EOD
$series3 << EOD
0.641,1.84710479e-06,,
0.643,5.32576371e-06,,2.38175394e-06
0.645,2.48023351e-05,,5.69004591e-06
0.647,5.90977255e-05,,2.64293063e-05
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
