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
set output 'committor.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set key maxcols 3 width -1
set xlabel 'crystallite size  [grains]'
set ylabel 'share that grows'
set xtics 5
set format x '%.0f'
set ytics 0.2
set format y '%.1f'
set xrange [0:21]
set yrange [0:1]
set offsets 0, 0, 0, 0
set arrow from graph 0, first 0.5 to graph 1, first 0.5 nohead dt 2 lc rgb '#888888'
set arrow from graph 0, first 0.583333333 to graph 1, first 0.583333333 nohead dt 2 lc rgb '#0072b2'
$series0 << EOD
3,0.665777265,,0.91748501
5,0.232362939,,0.277913763
6,0.533097277,,0.21409768
7,0.630750772,,0.147359103
9,0.631072999,,0.14628111
10,0.681463886,,0.134199834
14,0.946838191,,0.0587210513
15,0.983148753,,0.0594745809
18,1.00713615,,0.106128326
EOD
$series1 << EOD
3.78409121,0.363636364,,0.242263444
6.3459338,0.727272727,,0.183652953
10.9814111,0.727272727,,0.171903123
16.4316767,1,,0.0904534034
EOD
plot keyentry with lines lc rgb '#0072b2' lw 1.2 notitle, \
     keyentry with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.1', \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle
set output
