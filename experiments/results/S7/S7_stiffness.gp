set terminal svg size 325,230 enhanced font 'Helvetica,10.67' background '#ffffff'
set encoding utf8
set datafile separator ','
set border 15 lw 0.8
set xtics in mirror scale 0.9,0.5
set ytics in mirror scale 0.9,0.5
set mxtics 2
set mytics 2
set autoscale noextend
set key above horizontal center noautotitle Left reverse samplen 1.2 spacing 0.9
set output 'S7_stiffness.svg'
set label '(c)' at screen 0.015, screen 0.96 left front
set key maxcols 2 width -3
set xlabel 'position  {/:Italic y}/{/:Italic h}'
set ylabel 'probability density  {/:Italic P}'
set xtics 0.2
set format x '%.1f'
set ytics 2
set format y '%.0f'
set xrange [0:1]
set yrange [*:*]
set offsets 0, 0, graph 0.05, graph 0.05
$series0 << EOD
0.025,0,,0
0.075,0.026560425,,0.0350593788
0.125,0.26560425,,0.133082547
0.175,0.690571049,,0.282159139
0.225,1.6998672,,0.512933972
0.275,1.43426295,,0.669498448
0.325,2.57636122,,1.17642963
0.375,0.982735724,,0.618413292
0.425,0.849933599,,0.296943891
0.475,2.5498008,,1.23701736
0.525,1.30146082,,0.58470028
0.575,0.637450199,,0.384436634
0.625,2.41699867,,1.17578712
0.675,1.62018592,,0.447803946
0.725,0.504648074,,0.260724103
0.775,1.08897742,,0.679185969
0.825,1.1686587,,0.694362625
0.875,0.132802125,,0.128732436
0.925,0.0531208499,,0.0519681268
0.975,0,,0
EOD
$series1 << EOD
0.025,0,,0
0.075,0,,0
0.125,0,,0
0.175,9.84615385,,3.7946857
0.225,0,,0
0.275,0.307692308,,0.69398501
0.325,0,,0
0.375,1.53846154,,0.517587521
0.425,0.615384615,,0.271660874
0.475,1.23076923,,2.77594004
0.525,0.307692308,,0.69398501
0.575,0,,0
0.625,0.923076923,,0.646770578
0.675,0.307692308,,0.218874371
0.725,0,,0
0.775,2.15384615,,1.5321206
0.825,1.53846154,,1.32099035
0.875,1.23076923,,1.59654354
0.925,0,,0
0.975,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic k} = 654 N/m', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic k} = 6540 N/m', \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
