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
set output 'accuracy-seeds.svg'
data = 'accuracy-seeds.csv'
set xlabel 'time step over 2/ω_{max}'
set ylabel 'volume fraction  {/:Italic ϕ}'
plot data using 3:5:6 with yerrorbars pt 7 lc rgb '#000000' title '8 seeds'
set output
