set terminal svg size 600,430 enhanced font 'Helvetica,14' background '#ffffff'
set encoding utf8
set datafile separator ','
set border 15 lw 1.2
set xtics in mirror scale 0.9,0.5
set ytics in mirror scale 0.9,0.5
set format '%h'
set mxtics 2
set mytics 2
set autoscale noextend
set key above horizontal center noautotitle Left reverse samplen 1.5 width 2
set bars 0.5
set output 'accuracy-seeds.svg'
set xlabel 'time step  [2/ω_{max}]'
set ylabel 'volume fraction  {/:Italic ϕ}'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.210262903,0.636055305,,0.000585171734
0.283045225,0.636536257,,0.000837950666
0.354694151,0.637812291,,0.000771774813
0.566100357,0.636719173,,0.000383615508
0.808702665,0.636241813,,0.000740886365
0.9514149,0.636000178,,0.000697903808
EOD
plot $series0 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     $series0 using 1:2 with points lc rgb '#000000' pt 7 ps 0.6 title '8 seeds'
set output
