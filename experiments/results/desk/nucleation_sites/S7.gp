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
set output 'S7.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set xlabel 'position  {/:Italic x}/{/:Italic w},  {/:Italic y}/{/:Italic h}'
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
0.075,0,,0
0.125,0,,0
0.175,0,,0
0.225,0,,0
0.275,0,,0
0.325,2.85714286,,1.86295966
0.375,0.816326531,,0.789487141
0.425,1.63265306,,0.813020956
0.475,8.16326531,,2.78769687
0.525,4.48979592,,2.44570311
0.575,1.63265306,,0.891034316
0.625,0,,0
0.675,0,,0
0.725,0.408163265,,0.568655404
0.775,0,,0
0.825,0,,0
0.875,0,,0
0.925,0,,0
0.975,0,,0
EOD
$series1 << EOD
0.025,0,,0
0.075,0,,0
0.125,0,,0
0.175,0,,0
0.225,1.2244898,,1.36117401
0.275,4.89795918,,2.54161391
0.325,2.44897959,,1.80763856
0.375,1.2244898,,0.588664401
0.425,2.44897959,,1.42042043
0.475,2.44897959,,0.849308377
0.525,0.408163265,,0.394743571
0.575,0.408163265,,0.596653553
0.625,0.816326531,,0.793151364
0.675,0.816326531,,0.533184627
0.725,1.63265306,,1.08613395
0.775,0.408163265,,0.557491327
0.825,0.816326531,,0.858018916
0.875,0,,0
0.925,0,,0
0.975,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic P}({/:Italic x}/{/:Italic w})', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic P}({/:Italic y}/{/:Italic h})', \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#d55e00' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
