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
set output 'S6_contacts.svg'
set label '(d)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'contacts per grain'
set xtics 0.002
set format x '%.3f'
set ytics 0.05
set format y '%.2f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from 0.645, graph 0 to 0.645, graph 1 nohead dt 2 lc rgb '#888888'
set arrow from 0.647, graph 0 to 0.647, graph 1 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.639301841,6.58637131,8.07416127e-05,0.0271851059
0.641361741,6.52224473,9.26806461e-05,0.011333748
0.643337156,6.54637716,6.77238929e-05,0.0115112686
0.645267402,6.56254129,8.12082978e-05,0.000815433829
0.646342941,6.55723702,5.48138216e-05,0.000881425053
EOD
$series1 << EOD
0.639275738,6.46780591,3.98443655e-05,0.0158526862
0.641136439,6.36124051,8.65572899e-05,0.00413320377
0.643311327,6.38701964,2.79286985e-05,0.00536797129
0.645309243,6.39317326,7.67571655e-05,0.0052002323
0.646662137,6.39975362,0.000250331208,0.0095240198
0.648143797,6.39743219,,
EOD
$series2 << EOD
0.639059609,6.61367089,6.36830813e-05,0.0326236202
0.641234522,6.47933193,8.90890563e-05,0.00516997221
0.643241924,6.49718143,3.31844129e-05,0.0063232993
0.645245496,6.5159743,5.92607557e-05,0.0032739149
0.646579549,6.52495255,0.00025769167,0.00585039398
0.648623165,6.53761041,0.000371472683,0.0130534459
EOD
$series3 << EOD
0.639242633,6.44542194,0.000242177205,0.0466341084
0.640950877,6.32116034,0.00017279269,0.0141743109
0.642988383,6.34924437,0.000182558755,0.00970322026
0.645159691,6.3589906,8.92089345e-05,0.00958922124
0.646897551,6.36263944,0.000267344521,0.00538715407
0.648557512,6.35308864,0.000265169546,0.0050844252
0.650286307,6.37411117,,
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
