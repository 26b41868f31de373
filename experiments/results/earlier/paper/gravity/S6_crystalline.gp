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
set output 'S6_crystalline.svg'
set label '(c)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'percentage crystalline  [%]'
set xtics 0.002
set format x '%.3f'
set ytics 0.2
set format y '%.1f'
set xrange [*:*]
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
set arrow from 0.645, graph 0 to 0.645, graph 1 nohead dt 2 lc rgb '#888888'
set arrow from 0.647, graph 0 to 0.647, graph 1 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.639301841,0.0334911124,8.07416127e-05,0.0109876803
0.641361741,0.0365526475,9.26806461e-05,0.0105381201
0.643337156,0.0535814211,6.77238929e-05,0.0196608386
0.645267402,0.207268072,8.12082978e-05,0.135637045
0.646342941,0.0870255963,5.48138216e-05,0.00748384659
EOD
$series1 << EOD
0.639275738,0.0182271164,3.98443655e-05,0.0105279071
0.641136439,0.0219302952,8.65572899e-05,0.00762362236
0.643311327,0.0587049941,2.79286985e-05,0.0282349053
0.645309243,0.19605225,7.67571655e-05,0.152832872
0.646662137,0.35625056,0.000250331208,0.151947923
0.648143797,0.404815282,,
EOD
$series2 << EOD
0.639059609,0.0365330365,6.36830813e-05,0.01055196
0.641234522,0.0649244857,8.90890563e-05,0.0172398512
0.643241924,0.08893343,3.31844129e-05,0.0484727881
0.645245496,0.190480997,5.92607557e-05,0.0973882433
0.646579549,0.415120169,0.00025769167,0.113544668
0.648623165,1.20239976,0.000371472683,0.160673965
EOD
$series3 << EOD
0.639242633,0.0243187197,0.000242177205,0.0160956897
0.640950877,0.03959239,0.00017279269,0.0109710811
0.642988383,0.0511691439,0.000182558755,0.0171039938
0.645159691,0.201216611,8.92089345e-05,0.0970936731
0.646897551,0.292259452,0.000267344521,0.0851030295
0.648557512,0.607477484,0.000265169546,0.171968048
0.650286307,1.37456625,,
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
