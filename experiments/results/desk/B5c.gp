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
set output 'B5c.svg'
data = 'B5c.csv'
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'percentage crystalline  [%]'
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
plot data using 4:(strcol(1) eq 'protocol=continuous' ? column(6) : NaN):5:7 with xyerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     data using 4:(strcol(1) eq 'protocol=continuous' ? column(6) : NaN) with linespoints lc rgb '#000000' pt 5 ps 0.6 title 'continuous shear', \
     data using 4:(strcol(1) eq 'protocol=paused' ? column(6) : NaN):5:7 with xyerrorbars lc rgb '#d62728' lw 0.8 pt 0 notitle, \
     data using 4:(strcol(1) eq 'protocol=paused' ? column(6) : NaN) with linespoints lc rgb '#d62728' pt 7 ps 0.6 title 'periodically paused shear'
set output
