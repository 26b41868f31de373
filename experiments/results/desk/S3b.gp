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
set output 'S3b.svg'
data = 'S3b.csv'
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'percentage crystalline  [%]'
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
plot data using 4:(strcol(1) eq 'steps_per_cycle=76923' ? column(6) : NaN):5:7 with xyerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     data using 4:(strcol(1) eq 'steps_per_cycle=76923' ? column(6) : NaN) with linespoints lc rgb '#000000' pt 5 ps 0.6 title '2.6×10^{-5} s', \
     data using 4:(strcol(1) eq 'steps_per_cycle=57143' ? column(6) : NaN):5:7 with xyerrorbars lc rgb '#d62728' lw 0.8 pt 0 notitle, \
     data using 4:(strcol(1) eq 'steps_per_cycle=57143' ? column(6) : NaN) with linespoints lc rgb '#d62728' pt 7 ps 0.6 title '3.5×10^{-5} s', \
     data using 4:(strcol(1) eq 'steps_per_cycle=45600' ? column(6) : NaN):5:7 with xyerrorbars lc rgb '#1f4fd8' lw 0.8 pt 0 notitle, \
     data using 4:(strcol(1) eq 'steps_per_cycle=45600' ? column(6) : NaN) with linespoints lc rgb '#1f4fd8' pt 9 ps 0.6 title '4.4×10^{-5} s', \
     data using 4:(strcol(1) eq 'steps_per_cycle=28571' ? column(6) : NaN):5:7 with xyerrorbars lc rgb '#2ca02c' lw 0.8 pt 0 notitle, \
     data using 4:(strcol(1) eq 'steps_per_cycle=28571' ? column(6) : NaN) with linespoints lc rgb '#2ca02c' pt 11 ps 0.6 title '7.0×10^{-5} s'
set output
