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
set output 'S6_onset.svg'
data = 'S6_onset.csv'
set xlabel 'amplitude  {/:Italic A}  [rad]'
set ylabel 'onset  {/:Italic ϕ}'
set xrange [0:0.12]
set yrange [*<0.6445:0.6475<*]
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#888888'
set arrow from graph 0, first 0.647 to graph 1, first 0.647 nohead dt 2 lc rgb '#888888'
plot 0.646 with lines dt 3 lc rgb '#888888' notitle, \
     data using 2:(strcol(3) eq 'on' ? column(5) : NaN):6 with yerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(3) eq 'on' ? column(5) : NaN) with points lc rgb '#000000' pt 5 ps 0.7 title 'gravity', \
     data using 2:(strcol(3) eq 'off' ? column(5) : NaN):6 with yerrorbars lc rgb '#d62728' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(3) eq 'off' ? column(5) : NaN) with points lc rgb '#d62728' pt 7 ps 0.7 title 'no gravity'
set output
