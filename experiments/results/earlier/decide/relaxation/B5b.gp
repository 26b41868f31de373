set terminal svg size 325,245 enhanced font 'Helvetica,10.67' background '#ffffff'
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
set output 'B5b.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'percentage crystalline  [%]'
set ytics 0.2
set format y '%.1f'
set xrange [*:*]
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
$series0 << EOD
0,0.0276261004,,0.00255145802
1,0.0264000058,,0.00373157149
2,0.0289800078,,0.00277464748
3,0.0297412039,,0.00338324889
4,0.0389074775,,0.00419012693
5,0.0506107469,,0.00916437189
6,0.0788459421,,0.0166881207
7,0.0999139222,,0.0197307625
8,0.168628844,,0.0331239988
9,0.229210702,,0.0537063358
10,0.32825607,,0.0781855841
11,0.455324799,,0.0950947647
12,0.618841732,,0.130098512
13,0.805051974,,0.16562106
14,0.984615933,,0.195186534
15,1.23262017,,0.236083025
EOD
$series1 << EOD
0,0.0276261004,,0.00255145802
1,0.0261500041,,0.00316712966
2,0.0287108449,,0.00306533108
3,0.0457244273,,0.0092231359
4,0.0541484776,,0.0133749894
5,0.0704029623,,0.0193250098
6,0.100595561,,0.0263665272
7,0.137434786,,0.0366388744
8,0.205550997,,0.0585255876
9,0.2743882,,0.085583805
10,0.362505954,,0.0939547034
11,0.472502225,,0.1174646
12,0.570039689,,0.143010426
13,0.750069048,,0.17990936
14,0.973758578,,0.22439657
15,1.25191667,,0.306240701
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'continuous shear', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title 'periodically paused shear', \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
