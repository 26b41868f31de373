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
set yrange [*:*]
set offsets 0, 0, graph 0.05, graph 0.05
$series0 << EOD
0.025,0,,0
0.075,0.034965035,,0.0376579509
0.125,0.839160839,,0.3711346
0.175,2.13286713,,0.543811003
0.225,1.64335664,,0.289973238
0.275,0.839160839,,0.185802085
0.325,0.839160839,,0.191367119
0.375,1.64335664,,0.504344582
0.425,1.53846154,,0.296017799
0.475,0.629370629,,0.2348014
0.525,0.769230769,,0.244530024
0.575,1.18881119,,0.444826972
0.625,1.53846154,,0.317024748
0.675,0.944055944,,0.326633651
0.725,0.804195804,,0.169159827
0.775,0.314685315,,0.102013692
0.825,0.979020979,,0.567165774
0.875,1.92307692,,0.34397519
0.925,1.3986014,,0.367051415
0.975,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic k} = 654 N/m', \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
