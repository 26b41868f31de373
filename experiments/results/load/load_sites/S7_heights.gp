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
0.075,0.034965035,,0.0357070835
0.125,0.839160839,,0.303548456
0.175,2.13286713,,0.460989993
0.225,1.64335664,,0.431557829
0.275,0.839160839,,0.24225031
0.325,0.839160839,,0.307447469
0.375,1.64335664,,0.49605045
0.425,1.53846154,,0.377413832
0.475,0.629370629,,0.196754355
0.525,0.769230769,,0.286091519
0.575,1.18881119,,0.436817138
0.625,1.53846154,,0.396793584
0.675,0.944055944,,0.392600565
0.725,0.804195804,,0.195800662
0.775,0.314685315,,0.124566192
0.825,0.979020979,,0.5189336
0.875,1.92307692,,0.434262773
0.925,1.3986014,,0.388229843
0.975,0,,0
EOD
$series1 << EOD
0.025,0,,0
0.075,0.034965035,,0.0357070835
0.125,0.839160839,,0.303548456
0.175,2.0979021,,0.462669004
0.225,1.64335664,,0.425010432
0.275,0.874125874,,0.260333144
0.325,0.874125874,,0.307204236
0.375,1.67832168,,0.498183845
0.425,1.46853147,,0.355472027
0.475,0.629370629,,0.177079746
0.525,0.769230769,,0.286091519
0.575,1.43356643,,0.495219826
0.625,1.46853147,,0.452985219
0.675,0.944055944,,0.410256006
0.725,0.699300699,,0.183394882
0.775,0.384615385,,0.154261498
0.825,0.944055944,,0.458163673
0.875,2.44755245,,0.503489928
0.925,0.769230769,,0.328086352
0.975,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic P}({/:Italic y}/{/:Italic h})', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic P}({/:Italic y}/1.675 {/:Italic L})', \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#d55e00' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
