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
set output 'S6_overlap.svg'
set label '(e)' at screen 0.015, screen 0.96 left front
set key maxcols 1 width -8
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'mean overlap  ⟨{/:Italic δ}⟩  [{/:Italic d}]'
set xtics 0.002
set format x '%.3f'
set ytics 0.0002
set format y '%.4f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.638998666,0.0038749729,0.00013807301,4.72078801e-05
0.641150823,0.00406356199,5.71516849e-05,1.85554887e-05
0.643265985,0.00407146966,8.42815375e-05,3.76934473e-05
0.645272767,0.00404064609,3.78196236e-05,4.72465155e-05
0.646412731,0.00400883075,0.000156558682,4.02182848e-05
0.648128858,0.00398474885,,
EOD
$series1 << EOD
0.639096458,0.00303488178,0.000153732885,4.09299457e-05
0.641180559,0.00310701531,4.46435244e-05,3.46631509e-05
0.643187804,0.00314308914,5.19421935e-05,1.2887836e-05
0.645427325,0.00308792467,2.7994041e-05,2.6790879e-05
0.646573086,0.00309321951,0.000190917656,2.98640805e-05
EOD
$series2 << EOD
0.637831303,0.00367154758,,
0.639052174,0.00388513767,0.000114167962,4.12982454e-05
0.641185783,0.00409826137,7.56909539e-05,2.50492943e-05
0.643188536,0.00406718757,6.43097261e-05,2.74331378e-05
0.645208385,0.004049556,7.20046797e-05,3.06848752e-05
0.646932748,0.00405937433,7.90368072e-05,2.93135733e-05
0.648425245,0.00402695171,9.68926875e-05,3.48214856e-05
EOD
$series3 << EOD
0.63911274,0.00299162486,8.53070234e-05,1.82193532e-05
0.641248315,0.00314832193,5.85609407e-05,1.11670028e-05
0.643192635,0.00313462026,5.33720779e-05,1.08615483e-05
0.645254943,0.00310021711,4.34922918e-05,1.03071314e-05
0.646821507,0.00308179395,8.40835101e-05,1.31569808e-05
0.64833272,0.00308893804,0.000164833081,1.29779421e-05
0.650158976,0.00309235794,,
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
