set terminal svg size 325,275 enhanced font 'Helvetica,10.67' background '#ffffff'
set encoding utf8
set datafile separator ','
set border 15 lw 0.8
set xtics in mirror scale 0.9,0.5
set ytics in mirror scale 0.9,0.5
set mxtics 2
set mytics 2
set autoscale noextend
set key above horizontal center noautotitle Left reverse samplen 1.2 spacing 0.9
set output 'S5b.svg'
set key maxcols 1 width -7
set xlabel 'grains {/:Italic N}'
set ylabel 'onset {/:Italic ϕ}'
set xtics 2000
set format x '%.0f'
set ytics 0.0005
set format y '%.4f'
set xrange [*:*]
set yrange [0.644599618:0.647427139]
set offsets graph 0.03, graph 0.03, 0, 0
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#000000'
set arrow from graph 0, first 0.647 to graph 1, first 0.647 nohead dt 2 lc rgb '#000000'
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#888888'
$series0 << EOD
5200,0.646945985,,0.000352630558
7900,0.64660154,,0.000359838519
11400,0.645926316,,0.000646336318
18200,0.645158536,,0.000430394366
EOD
$series3 << EOD
11400,0.64632,,0.00032
18200,0.64577,,0.00039
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '6 to 12 runs', \
     keyentry with lines lc rgb '#000000' lw 1.2 dt 2 title 'the supplement 0.646 ± 0.001', \
     keyentry with lines lc rgb '#888888' lw 1.2 dt 2 title 'experiment, {/:Italic A} = 0.01: 0.645', \
     keyentry with points lc rgb '#000000' lw 1.2 pt 6 ps 0.4 title 'prediction from smaller cells', \
     $series3 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series3 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
