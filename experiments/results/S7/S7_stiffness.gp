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
set ytics 1
set format y '%.0f'
set xrange [0:1]
set yrange [*:*]
set offsets 0, 0, graph 0.05, graph 0.05
$series0 << EOD
0.0625,0.02124834,,0.028047503
0.1875,1.05179283,,0.154680324
0.3125,1.86985392,,0.274588575
0.4375,1.4873838,,0.58963634
0.5625,1.15803453,,0.109816148
0.6875,1.43426295,,0.454200187
0.8125,0.924302789,,0.363929652
0.9375,0.0531208499,,0.056238198
EOD
$series1 << EOD
0.0625,0,,0
0.1875,3.93846154,,1.51787428
0.3125,0.492307692,,0.30985123
0.4375,0.984615385,,0.948879202
0.5625,0.123076923,,0.277594004
0.6875,0.492307692,,0.217328699
0.8125,1.96923077,,0.369945917
0.9375,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic k} = 654 N/m', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic k} = 6540 N/m', \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
