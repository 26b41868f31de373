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
data = 'S7.csv'
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
0.275,0.727272727,,0.891719936
0.325,3.27272727,,1.64600881
0.375,0.727272727,,0.752604786
0.425,1.45454545,,0.785542646
0.475,7.27272727,,2.60338107
0.525,4,,2.06875237
0.575,1.45454545,,0.816042487
0.625,0,,0
0.675,0,,0
0.725,0.363636364,,0.522879193
0.775,0.727272727,,0.511879864
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
0.225,1.09090909,,1.29584056
0.275,5.09090909,,2.08488673
0.325,2.54545455,,1.67459751
0.375,1.45454545,,0.569656313
0.425,2.90909091,,1.38625956
0.475,2.18181818,,0.830074425
0.525,0.363636364,,0.376302393
0.575,0.363636364,,0.55487031
0.625,0.727272727,,0.69596586
0.675,0.727272727,,0.437782272
0.725,1.45454545,,1.03871657
0.775,0.363636364,,0.526060328
0.825,0.727272727,,0.756137966
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
