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
0.075,0.0498132005,,0.0472665325
0.125,1.27023661,,0.263881444
0.175,1.91780822,,0.338281358
0.225,1.17061021,,0.308788412
0.275,1.54420922,,0.395931932
0.325,1.59402242,,0.329608109
0.375,0.921544209,,0.292389181
0.425,1.91780822,,0.417676081
0.475,1.17061021,,0.31107944
0.525,1.04607721,,0.245740347
0.575,1.17061021,,0.298390828
0.625,1.34495641,,0.2921862
0.675,0.697384807,,0.175232268
0.725,1.04607721,,0.323360848
0.775,0.597758406,,0.21044785
0.825,1.44458281,,0.523323173
0.875,1.04607721,,0.294201731
0.925,0.0498132005,,0.0525267942
0.975,0,,0
EOD
$series1 << EOD
0.025,0,,0
0.075,0.099626401,,0.094533065
0.125,1.36986301,,0.274369598
0.175,1.91780822,,0.327353285
0.225,1.44458281,,0.34585954
0.275,1.44458281,,0.359144286
0.325,1.49439601,,0.325548339
0.375,1.12079701,,0.231793195
0.425,1.79327522,,0.376207738
0.475,1.14570361,,0.293647761
0.525,1.09589041,,0.292150557
0.575,1.39476961,,0.366372945
0.625,0.99626401,,0.258757727
0.675,1.17061021,,0.326006423
0.725,0.697384807,,0.239147799
0.775,0.871731009,,0.271860625
0.825,1.56911582,,0.45453121
0.875,0.373599004,,0.171610799
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
