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
set output 'nucleation_b.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'onsets per grain and cycle'
set xtics 0.002
set format x '%.3f'
set logscale y
unset mytics
set ytics (1e-06,2e-06)
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.639,3.28447243e-06,,
0.641,1.53211857e-06,,
0.643,1.599768e-06,,9.23626488e-07
0.645,1.28435917e-06,,4.5408954e-07
0.647,2.0321655e-06,,7.68086363e-07
EOD
plot keyentry with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.05, {/:Italic N} = 18200', \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#0072b2' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
