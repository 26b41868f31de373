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
set output 'S5b.svg'
set xlabel 'grains  {/:Italic N}'
set ylabel 'onset  {/:Italic ϕ}'
set xtics 5000
set format x '%.0f'
set ytics 0.001
set format y '%.3f'
set xrange [0:20000]
set yrange [*<0.6445:0.6475<*]
set offsets 0, 0, graph 0.05, graph 0.05
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#888888'
set arrow from graph 0, first 0.647 to graph 1, first 0.647 nohead dt 2 lc rgb '#888888'
$series0 << EOD
5200,0.646406502,,0.000236413751
18200,0.644091535,,0.00148363447
EOD
$series1 << EOD
0,0.645,,
20000,0.645,,
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'simulated', \
     keyentry with lines lc rgb '#e69f00' lw 1.2 title 'experiment, {/:Italic A} = 0.01', \
     $series1 every 1 using 1:2 with lines lc rgb '#e69f00' lw 1.2 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
