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
set ytics 0.5
set format y '%.1f'
set xrange [0:1]
set yrange [*:*]
set offsets 0, 0, graph 0.05, graph 0.05
$series0 << EOD
0.025,0,,0
0.075,0,,0
0.125,0,,0
0.175,0.622665006,,0.232781039
0.225,0.871731009,,0.246424997
0.275,1.74346202,,0.283373352
0.325,1.27023661,,0.21652956
0.375,1.89290162,,0.429587484
0.425,1.76836862,,0.420191459
0.475,1.22042341,,0.264290793
0.525,2.04234122,,0.403814829
0.575,1.22042341,,0.29591426
0.625,1.19551681,,0.278291159
0.675,1.94271482,,0.432628064
0.725,2.14196762,,0.375790238
0.775,1.59402242,,0.356827384
0.825,0.473225405,,0.247204626
0.875,0,,0
0.925,0,,0
0.975,0,,0
EOD
$series1 << EOD
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
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic P}({/:Italic x}/{/:Italic w})', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic P}({/:Italic y}/{/:Italic h})', \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#d55e00' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
