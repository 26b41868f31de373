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
set output 'C_critical_size.svg'
data = 'C_critical_size.csv'
set xlabel 'amplitude  {/:Italic A}  [rad]'
set ylabel 'critical size  [grains]'
set xrange [0:0.12]
set yrange [0:*]
plot data using 1:5 with linespoints lc rgb '#888888' dt 2 pt 6 title 'supplement', \
     data using 1:3:4 with yerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     data using 1:3 with points lc rgb '#000000' pt 5 ps 0.7 title 'simulated'
set output
