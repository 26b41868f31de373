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
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set key above horizontal center noautotitle Left reverse samplen 1.5 width 2
set bars 0.5
set output 'S5a.svg'
data = 'S5a.csv'
set xlabel 'amplitude  {/:Italic A}  [rad]'
set ylabel 'onset  {/:Italic ϕ}'
set xrange [0:0.12]
set yrange [*<0.6445:0.6475<*]
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#888888'
set arrow from graph 0, first 0.647 to graph 1, first 0.647 nohead dt 2 lc rgb '#888888'
$experiment << EOD
0.01,0.645
EOD
plot $experiment using 1:2 with points lc rgb '#ff7f0e' pt 7 ps 0.8 title 'experiment', \
     data using 2:(column(1) == 1 ? column(4) : NaN):5 with yerrorbars lc rgb '#1f4fd8' lw 0.8 pt 0 notitle, \
     data using 2:(column(1) == 1 ? column(4) : NaN) with points lc rgb '#1f4fd8' pt 9 ps 0.7 title 'largest crystallite is critical', \
     data using ($2 + 0.001):(column(1) == 2 ? column(4) : NaN):5 with yerrorbars lc rgb '#2ca02c' lw 0.8 pt 0 notitle, \
     data using ($2 + 0.001):(column(1) == 2 ? column(4) : NaN) with points lc rgb '#2ca02c' pt 13 ps 0.7 title 'steepest growth'
set output
