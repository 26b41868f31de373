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
set bars 0.5
set output 'S7_stiffness.svg'
set label '(c)' at screen 0.015, screen 0.96 left front
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
0.025,0,,0
0.075,0,,0
0.125,0,,0
0.175,0,,0
0.225,1.2244898,,1.15142327
0.275,4.89795918,,2.43136225
0.325,2.44897959,,2.01021604
0.375,1.2244898,,0.550818482
0.425,2.44897959,,1.42872323
0.475,2.44897959,,0.818882754
0.525,0.408163265,,0.401876691
0.575,0.408163265,,0.554666598
0.625,0.816326531,,0.794602452
0.675,0.816326531,,0.530048604
0.725,1.63265306,,1.09714002
0.775,0.408163265,,0.575488755
0.825,0.816326531,,0.530048604
0.875,0,,0
0.925,0,,0
0.975,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic k} = 654 N/m', \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
