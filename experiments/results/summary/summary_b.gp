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
set output 'summary_b.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set key maxcols 2 width -2
set xlabel 'interior grains  {/:Italic N}_{inves}'
set ylabel 'onset  {/:Italic ϕ}'
set logscale x
unset mxtics
set xtics (5000,10000)
set ytics 0.0005
set format y '%.4f'
set xrange [*:*]
set yrange [0.644597129:0.647274397]
set offsets graph 0.03, graph 0.03, 0, 0
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#888888'
set arrow from graph 0, first 0.647 to graph 1, first 0.647 nohead dt 2 lc rgb '#888888'
$series0 << EOD
3389.25,0.64677253,,0.000380173497
5479.75,0.646452507,,0.000343689439
8283.5,0.645694276,,0.000463024011
13909.6667,0.645158536,,0.00043971327
EOD
plot keyentry with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title 'system\_size', \
     $series0 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
