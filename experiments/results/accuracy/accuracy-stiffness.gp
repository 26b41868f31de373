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
set output 'accuracy-stiffness.svg'
data = 'accuracy-stiffness.csv'
set logscale x
set xlabel 'seconds per cycle of 600 sheared grains'
set ylabel 'bias of the volume fraction'
plot data using 2:8:9 with yerrorbars pt 6 lc rgb '#000000' title '{/:Italic ϕ}_u', \
     data using 2:5:6 with yerrorbars pt 7 lc rgb '#d62728' title '{/:Italic ϕ} (S4)', \
     0 lc rgb '#888888' notitle
set output
