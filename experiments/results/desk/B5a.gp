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
set output 'B5a.svg'
data = 'B5a.csv'
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'volume fraction  {/:Italic ϕ}'
plot data using 2:(strcol(1) eq 'protocol=continuous' && int(column(2)) % 2 == 0 ? column(3) : NaN):4 with yerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'protocol=continuous' ? column(3) : NaN) with lines lc rgb '#000000' notitle, \
     data using 2:(strcol(1) eq 'protocol=continuous' && int(column(2)) % 2 == 0 ? column(3) : NaN) with points lc rgb '#000000' pt 5 ps 0.6 title 'continuous shear', \
     data using 2:(strcol(1) eq 'protocol=paused' && int(column(2)) % 2 == 0 ? column(3) : NaN):4 with yerrorbars lc rgb '#d62728' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'protocol=paused' ? column(3) : NaN) with lines lc rgb '#d62728' notitle, \
     data using 2:(strcol(1) eq 'protocol=paused' && int(column(2)) % 2 == 0 ? column(3) : NaN) with points lc rgb '#d62728' pt 7 ps 0.6 title 'periodically paused shear'
set output
