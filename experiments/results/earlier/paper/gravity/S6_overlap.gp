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
set output 'S6_overlap.svg'
set label '(e)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'mean overlap  ⟨{/:Italic δ}⟩  [{/:Italic d}]'
set xtics 0.002
set format x '%.3f'
set ytics 0.0002
set format y '%.4f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from 0.645, graph 0 to 0.645, graph 1 nohead dt 2 lc rgb '#888888'
set arrow from 0.647, graph 0 to 0.647, graph 1 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.639301841,0.00389461669,8.07416127e-05,5.89535377e-05
0.641361741,0.00407589025,9.26806461e-05,2.82575037e-05
0.643337156,0.00407835673,6.77238929e-05,4.74097551e-05
0.645267402,0.00407378401,8.12082978e-05,1.69867705e-05
0.646342941,0.00405207213,5.48138216e-05,7.6069057e-06
EOD
$series1 << EOD
0.639275738,0.00295359537,3.98443655e-05,8.90690421e-05
0.641136439,0.0031844953,8.65572899e-05,3.06568638e-05
0.643311327,0.00316964446,2.79286985e-05,2.55863313e-05
0.645309243,0.00312272447,7.67571655e-05,1.58456887e-05
0.646662137,0.00309420625,0.000250331208,2.65515157e-05
0.648143797,0.00309397997,,
EOD
$series2 << EOD
0.639059609,0.00386203321,6.36830813e-05,5.98950961e-05
0.641234522,0.00415945633,8.90890563e-05,2.71248549e-05
0.643241924,0.00409418299,3.31844129e-05,1.24056459e-05
0.645245496,0.00406073051,5.92607557e-05,4.20613751e-05
0.646579549,0.00402720694,0.00025769167,4.96886255e-05
0.648623165,0.00395194069,0.000371472683,5.62874497e-05
EOD
$series3 << EOD
0.639242633,0.0029494889,0.000242177205,3.57385994e-05
0.640950877,0.00317880348,0.00017279269,3.54526694e-05
0.642988383,0.00322496197,0.000182558755,9.23951577e-06
0.645159691,0.0031831086,8.92089345e-05,4.357106e-05
0.646897551,0.00315953395,0.000267344521,2.5116509e-05
0.648557512,0.00310945033,0.000265169546,1.91770744e-05
0.650286307,0.00309157062,,
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.04, gravity', \
     keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 4 ps 0.4 title '{/:Italic A} = 0.04, no gravity', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.05, gravity', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic A} = 0.05, no gravity', \
     $series3 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series2 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series3 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 4 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
