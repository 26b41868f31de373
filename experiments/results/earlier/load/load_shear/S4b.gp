set terminal svg size 325,260 enhanced font 'Helvetica,10.67' background '#ffffff'
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
set output 'S4b.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'percentage crystalline  [%]'
set xtics 0.002
set format x '%.3f'
set ytics 2
set format y '%.0f'
set xrange [*:*]
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
$series0 << EOD
0.637503724,0.088365243,,
0.639088033,0.0229966683,0.000164847099,0.0118534516
0.641194009,0.0558140172,0.000167985719,0.0131766314
0.643052916,0.0463289661,9.23911118e-05,0.0162431299
0.644364463,0.335452107,0.000132514701,0.292538989
EOD
$series1 << EOD
0.639427848,0.0172423537,0.000159083179,0.00246693994
0.641123609,0.047183526,7.93939414e-05,0.0109412784
0.642913641,0.0503570424,8.72800416e-05,0.0153984904
0.644785546,1.65699701,,
0.647264656,4.45316613,,
0.649374229,7.74240074,,
0.651029421,7.83096927,,
EOD
$series2 << EOD
0.638850894,0.0769050828,0.000381548511,0.0226585122
0.641110016,0.0496808213,0.000280084387,0.00662850119
0.643179056,0.0682262926,5.47541127e-05,0.0196110783
0.644717749,0.465782719,9.43334022e-05,0.285557627
0.64674122,2.76273065,,
EOD
plot keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 9 ps 0.4 title 'top fixed', \
     keyentry with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'top moves vertically', \
     keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 title 'top fixed, {/:Italic P} on the bottom wall', \
     $series2 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 9 ps 0.4 notitle
set output
