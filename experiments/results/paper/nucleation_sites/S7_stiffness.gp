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
set ytics 0.5
set format y '%.1f'
set xrange [0:1]
set yrange [0:*]
set offsets 0, 0, graph 0.05, 0
$series0 << EOD
0.025,0,,0
0.075,0,,0
0.125,1.88679245,,0.946244155
0.175,1.50943396,,0.489287841
0.225,0.754716981,,0.608456541
0.275,0.566037736,,0.246552471
0.325,0.377358491,,0.274168182
0.375,1.13207547,,0.845015634
0.425,1.50943396,,0.801136447
0.475,0.943396226,,0.619649367
0.525,1.13207547,,0.776077338
0.575,0.943396226,,0.574218429
0.625,2.45283019,,0.968082757
0.675,0.943396226,,0.535057728
0.725,2.26415094,,0.941970454
0.775,0.377358491,,0.201107826
0.825,0.566037736,,0.230484445
0.875,2.64150943,,0.975046213
0.925,0,,0
0.975,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic k} = 654 N/m', \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
