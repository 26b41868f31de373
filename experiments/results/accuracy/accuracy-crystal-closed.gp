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
set output 'accuracy-crystal-closed.svg'
data = 'accuracy-crystal-closed.csv'
set logscale xy
set format y '10^{%T}'
set xlabel 'seconds per cycle of 600 sheared grains'
set ylabel 'distance [{/:Italic d}]'
set title 'FCC crystal, contacts stay closed: position after 3 contact times' font ',12'
plot data using (strcol(1) eq 'engine' ? $6 : NaN):7 with linespoints lc rgb '#000000' pt 7 ps 0.7 title 'engine', \
     data using (strcol(1) eq 'leapfrog' ? $6 : NaN):7 with linespoints lc rgb '#888888' pt 6 ps 0.7 title 'leapfrog', \
     data using (strcol(1) eq 'leapfrog exact drag' ? $6 : NaN):7 with linespoints lc rgb '#d62728' pt 5 ps 0.7 title 'leapfrog exact drag', \
     data using (strcol(1) eq 'PEFRL' ? $6 : NaN):7 with linespoints lc rgb '#1f4fd8' pt 9 ps 0.7 title 'PEFRL', \
     data using (strcol(1) eq 'Runge-Kutta' ? $6 : NaN):7 with linespoints lc rgb '#2ca02c' pt 11 ps 0.7 title 'Runge-Kutta', \
     data using (strcol(1) eq 'leapfrog single' ? $6 : NaN):7 with linespoints lc rgb '#e377c2' pt 4 ps 0.7 title 'leapfrog single', \
     data using (strcol(1) eq 'leapfrog mixed' ? $6 : NaN):7 with linespoints lc rgb '#8c564b' pt 8 ps 0.7 title 'leapfrog mixed'
set output
