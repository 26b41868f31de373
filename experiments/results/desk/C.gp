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
set output 'C.svg'
data = 'C.csv'
set xlabel 'crystallite size  [grains]'
set ylabel '{/:Italic Δρ} = {/:Italic ρ}_{g} − {/:Italic ρ}_{s}'
set xrange [0:60]
set yrange [-1.05:1.05]
set offsets 0,0,0,0
set arrow from graph 0, first 0 to graph 1, first 0 nohead dt 2 lc rgb '#888888'
set arrow from 16, graph 0 to 16, graph 0.06 nohead lw 2 lc rgb '#6a3d9a'
set arrow from 20, graph 0 to 20, graph 0.06 nohead lw 2 lc rgb '#000000'
plot data using 2:(column(1) == 0.0833 ? column(6) : NaN):7 with yerrorbars lc rgb '#6a3d9a' lw 0.8 pt 0 notitle, \
     data using 2:(column(1) == 0.0833 ? column(6) : NaN) with points lc rgb '#6a3d9a' pt 5 ps 0.7 title '{/:Italic A} = 0.0833',      data using 2:(column(1) == 0.1 ? column(6) : NaN):7 with yerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     data using 2:(column(1) == 0.1 ? column(6) : NaN) with points lc rgb '#000000' pt 7 ps 0.7 title '{/:Italic A} = 0.1'
set output
