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
set output 'S7_heights.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set key maxcols 2 width -3
set xlabel 'position  {/:Italic y}/{/:Italic h},  {/:Italic y}/1.675 {/:Italic L}'
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
0.075,0.026560425,,0.0350593788
0.125,0.3187251,,0.182830901
0.175,0.770252324,,0.246700557
0.225,1.67330677,,0.578709167
0.275,1.99203187,,0.362536488
0.325,2.31075697,,0.802424106
0.375,0.610889774,,0.334113804
0.425,2.09827357,,1.0276427
0.475,1.93891102,,0.648022216
0.525,0.770252324,,0.242971863
0.575,0.743691899,,0.352953291
0.625,2.6560425,,1.18357808
0.675,1.30146082,,0.470232736
0.725,0.717131474,,0.492607567
0.775,1.30146082,,0.694657718
0.825,0.637450199,,0.536862077
0.875,0.132802125,,0.140595495
0.925,0,,0
0.975,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic P}({/:Italic y}/{/:Italic h})', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic P}({/:Italic y}/1.675 {/:Italic L})', \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
