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
set output 'C_largest.svg'
set label '(c)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'largest crystallite  [grains]'
set xtics 0.002
set format x '%.3f'
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*<10:10<*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from graph 0, first 10 to graph 1, first 10 nohead dt 2 lc rgb '#6a3d9a'
$series0 << EOD
0.637626936,1,,
0.639181816,1,0.000110373952,0
0.641131497,1.06666667,0.000119563385,0.0666666667
0.643326697,1.4584267,3.67811275e-05,0.379453873
0.645346152,5.97429584,6.49024462e-05,4.46812962
0.646691171,14.8843131,0.000147677694,11.1654781
0.648645704,101.373585,,
EOD
plot keyentry with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.04', \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#6a3d9a' fs transparent solid 0.2 noborder notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 notitle
set output
