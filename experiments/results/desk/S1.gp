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
set output 'S1.svg'
data = 'S1.csv'
set xlabel 'mean overlap  ⟨{/:Italic δ}⟩  [{/:Italic d}]'
set ylabel 'volume fraction  {/:Italic ϕ}'
set logscale x
set format x '10^{%L}'
set mxtics 10
plot data using 2:4:5 with yerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     data using 2:4 with points lc rgb '#000000' pt 6 ps 0.7 title '{/:Italic ϕ}_u, uncorrected', \
     data using 2:6:7 with yerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     data using 2:6 with points lc rgb '#000000' pt 7 ps 0.7 title '{/:Italic ϕ}'
set output
