set terminal svg size 325,245 enhanced font 'Helvetica,10.67' background '#ffffff'
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
set output 'nucleation_b.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'onsets per grain and cycle'
set xtics 0.001
set format x '%.3f'
set logscale y
unset mytics
set ytics (1e-06,2e-06,5e-06)
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.645,1.006071e-06,,
0.647,3.25987743e-06,,2.30508144e-06
EOD
$series1 << EOD
0.641,9.00511491e-06,,
0.643,6.89982644e-06,,
0.647,1.12671613e-06,,
EOD
plot keyentry with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.05, {/:Italic N} = 5200', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.05, {/:Italic N} = 18200', \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#0072b2' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
