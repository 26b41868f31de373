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
set output 'S6_crystalline.svg'
set label '(c)' at screen 0.015, screen 0.96 left front
set key maxcols 1 width -8
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'percentage crystalline  [%]'
set xtics 0.002
set format x '%.3f'
set ytics 0.5
set format y '%.1f'
set xrange [*:*]
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
$series0 << EOD
0.638998666,0.0182620988,0.00013807301,0.00972482687
0.641150823,0.033647145,5.71516849e-05,0.00662730237
0.643265985,0.0475045263,8.42815375e-05,0.0107575958
0.645272767,0.0821683854,3.78196236e-05,0.0159264356
0.646412731,0.134560162,0.000156558682,0.0370793906
0.648128858,0.288482102,,
EOD
$series1 << EOD
0.639096458,0.0296262801,0.000153732885,0.00436648757
0.641180559,0.0293792168,4.46435244e-05,0.00261680263
0.643187804,0.0406488135,5.19421935e-05,0.00450846258
0.645427325,0.0929594415,2.7994041e-05,0.0400372286
0.646573086,0.135940902,0.000190917656,0.0608812453
EOD
$series2 << EOD
0.637831303,0,,
0.639052174,0.0235950341,0.000114167962,0.00520452288
0.641185783,0.0359035284,7.56909539e-05,0.0053557836
0.643188536,0.0335606423,6.43097261e-05,0.00318201168
0.645208385,0.0847659553,7.20046797e-05,0.0231230028
0.646932748,0.44161503,7.90368072e-05,0.186355753
0.648425245,1.31864418,9.68926875e-05,0.327108811
EOD
$series3 << EOD
0.63911274,0.0319302522,8.53070234e-05,0.0073284546
0.641248315,0.0305825311,5.85609407e-05,0.003656886
0.643192635,0.0511690348,5.33720779e-05,0.00912787227
0.645254943,0.132887153,4.34922918e-05,0.0512508129
0.646821507,0.426694783,8.40835101e-05,0.0992092494
0.64833272,1.16041119,0.000164833081,0.302772739
0.650158976,3.2864707,,
EOD
plot keyentry with linespoints lc rgb '#cc79a7' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.04, gravity (1 to 6 runs)', \
     keyentry with linespoints lc rgb '#cc79a7' lw 1.2 pt 4 ps 0.4 title '{/:Italic A} = 0.04, no gravity', \
     keyentry with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.05, gravity (1 to 12 runs)', \
     keyentry with linespoints lc rgb '#000000' lw 1.2 pt 6 ps 0.4 title '{/:Italic A} = 0.05, no gravity (1 to 12 runs)', \
     $series3 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series2 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#cc79a7' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#cc79a7' fs transparent solid 0.2 noborder notitle, \
     $series3 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 6 ps 0.4 notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#cc79a7' lw 1.2 pt 4 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#cc79a7' lw 1.2 pt 5 ps 0.4 notitle
set output
