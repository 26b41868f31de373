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
set yrange [*:*]
set offsets 0, 0, graph 0.05, graph 0.05
$series0 << EOD
0.025,0,,0
0.075,0.0498132005,,0.0504435229
0.125,1.27023661,,0.275842584
0.175,1.91780822,,0.331939976
0.225,1.17061021,,0.280097452
0.275,1.54420922,,0.411906664
0.325,1.59402242,,0.315646554
0.375,0.921544209,,0.298406308
0.425,1.91780822,,0.475098462
0.475,1.17061021,,0.263234161
0.525,1.04607721,,0.268373143
0.575,1.17061021,,0.169386368
0.625,1.34495641,,0.382157648
0.675,0.697384807,,0.199521964
0.725,1.04607721,,0.309403751
0.775,0.597758406,,0.195389576
0.825,1.44458281,,0.689709169
0.875,1.04607721,,0.292009274
0.925,0.0498132005,,0.0518220724
0.975,0,,0
EOD
$series1 << EOD
0.025,0,,0
0.075,0.099626401,,0.100887046
0.125,1.36986301,,0.284422093
0.175,1.91780822,,0.347206387
0.225,1.44458281,,0.310595843
0.275,1.44458281,,0.398639115
0.325,1.49439601,,0.29330896
0.375,1.12079701,,0.276482163
0.425,1.79327522,,0.38485822
0.475,1.14570361,,0.282655524
0.525,1.09589041,,0.298810618
0.575,1.39476961,,0.252298742
0.625,0.99626401,,0.268803425
0.675,1.17061021,,0.323902435
0.725,0.697384807,,0.225369781
0.775,0.871731009,,0.222017526
0.825,1.56911582,,0.436085181
0.875,0.373599004,,0.177719843
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
