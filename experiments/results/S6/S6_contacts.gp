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
set output 'S6_contacts.svg'
set label '(d)' at screen 0.015, screen 0.96 left front
set key maxcols 1 width -8
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'contacts per grain'
set xtics 0.002
set format x '%.3f'
set ytics 0.05
set format y '%.2f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.638998666,6.59605485,0.00013807301,0.017064733
0.641150823,6.52770499,5.71516849e-05,0.00652215951
0.643265985,6.53948741,8.42815375e-05,0.00858562745
0.645272767,6.55268767,3.78196236e-05,0.00850389052
0.646412731,6.55456223,0.000156558682,0.00727018152
0.648128858,6.55370189,,
EOD
$series1 << EOD
0.639096458,6.44776899,0.000153732885,0.0181482927
0.641180559,6.35373681,4.46435244e-05,0.00612500581
0.643187804,6.37162001,5.19421935e-05,0.0010084352
0.645427325,6.38626582,2.7994041e-05,0.00700322014
0.646573086,6.39106205,0.000190917656,0.00648299029
EOD
$series2 << EOD
0.637831303,6.61670886,,
0.639052174,6.56243143,0.000114167962,0.0160938226
0.641185783,6.475125,7.56909539e-05,0.00498320365
0.643188536,6.49574418,6.43097261e-05,0.00645727415
0.645208385,6.51215966,7.20046797e-05,0.00524760393
0.646932748,6.52862746,7.90368072e-05,0.00555328131
0.648425245,6.54546585,9.68926875e-05,0.00931442563
EOD
$series3 << EOD
0.63911274,6.43591245,8.53070234e-05,0.0146822845
0.641248315,6.32672152,5.85609407e-05,0.00751995924
0.643192635,6.33722558,5.33720779e-05,0.00335259391
0.645254943,6.34537085,4.34922918e-05,0.0020207712
0.646821507,6.35450414,8.40835101e-05,0.00196157195
0.64833272,6.36478115,0.000164833081,0.00726074466
0.650158976,6.37506329,,
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
