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
set output 'S7_heights.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set xlabel 'position  {/:Italic y}/{/:Italic h},  {/:Italic y}/1.675 {/:Italic L}'
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
0.075,0.165289256,,0.157838697
0.125,1.65289256,,0.494595021
0.175,1.65289256,,0.474365682
0.225,1.07438017,,0.45036355
0.275,1.23966942,,0.795024692
0.325,1.23966942,,0.517439232
0.375,0.909090909,,0.41528906
0.425,2.39669421,,1.07786794
0.475,0.743801653,,0.379080289
0.525,0.991735537,,0.533506065
0.575,1.57024793,,0.748252755
0.625,1.73553719,,0.550259034
0.675,0.495867769,,0.322511965
0.725,1.15702479,,0.620775467
0.775,0.578512397,,0.439570992
0.825,0.247933884,,0.155751621
0.875,2.14876033,,0.7470299
0.925,0,,0
0.975,0,,0
EOD
$series1 << EOD
0.025,0,,0
0.075,0.330578512,,0.315677394
0.125,1.48760331,,0.510882323
0.175,1.73553719,,0.458249124
0.225,1.65289256,,0.765512494
0.275,0.826446281,,0.529143238
0.325,1.23966942,,0.464227603
0.375,1.15702479,,0.56484179
0.425,2.23140496,,0.859926272
0.475,0.578512397,,0.38712296
0.525,0.909090909,,0.472633963
0.575,1.98347107,,0.889145512
0.625,1.57024793,,0.614931544
0.675,1.15702479,,0.75701321
0.725,0.578512397,,0.443022699
0.775,0.41322314,,0.223373704
0.825,1.32231405,,0.611448732
0.875,0.826446281,,0.513045437
0.925,0,,0
0.975,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic P}({/:Italic y}/{/:Italic h})', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic P}({/:Italic y}/1.675 {/:Italic L})', \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#d55e00' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
