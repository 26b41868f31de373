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
set output 'B5c.svg'
set label '(c)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'percentage crystalline  [%]'
set xtics 0.005
set format x '%.3f'
set ytics 2
set format y '%.0f'
set xrange [*:*]
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
$series0 << EOD
0.63781022,0.0242689283,5.75070575e-05,0.00767398357
0.639139228,0.0271919707,3.42404773e-05,0.00232576375
0.641175979,0.0341688604,2.80324708e-05,0.00320993363
0.643003729,0.156513295,2.35782529e-05,0.0217765067
0.644620846,0.700855237,4.81928713e-05,0.102663811
0.646618842,3.08515237,7.38487913e-05,0.401088043
0.648793798,6.37194118,0.000195723957,0.678043308
EOD
$series1 << EOD
0.63781022,0.0242689283,5.75070575e-05,0.00767398357
0.638924025,0.0277987181,4.27008549e-05,0.0024640162
0.641150366,0.0290492477,3.09179375e-05,0.00184473705
0.643071526,0.0938780553,2.32726929e-05,0.0160688617
0.64468071,0.409647443,3.62946522e-05,0.0620899737
0.646631878,2.05676993,9.7781325e-05,0.30088179
0.648522665,5.42335335,9.67856015e-05,0.192577892
0.650467045,7.60328023,0.000198428879,0.481153634
0.652878602,11.1109461,0.000324174378,0.200858348
0.656103074,15.7616618,,
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'continuous shear', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title 'periodically paused shear', \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
