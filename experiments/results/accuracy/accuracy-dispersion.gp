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
set output 'accuracy-dispersion.svg'
data = 'accuracy-dispersion.csv'
set xlabel 'wave number  {/:Italic q}  [1/{/:Italic d}]'
set ylabel 'frequency  [rad/s]'
plot data using (strcol(1) eq 'row in the engine' ? $2 : NaN):3 with lines lc rgb '#000000' notitle, \
     data using (strcol(1) eq 'row in the engine' ? $2 : NaN):4 with points pt 7 lc rgb '#000000' title 'row in the engine', \
     data using (strcol(1) eq 'FCC longitudinal' ? $2 : NaN):3 with lines lc rgb '#d62728' notitle, \
     data using (strcol(1) eq 'FCC longitudinal' ? $2 : NaN):4 with points pt 7 lc rgb '#d62728' title 'FCC longitudinal', \
     data using (strcol(1) eq 'FCC transverse' ? $2 : NaN):3 with lines lc rgb '#1f4fd8' notitle, \
     data using (strcol(1) eq 'FCC transverse' ? $2 : NaN):4 with points pt 7 lc rgb '#1f4fd8' title 'FCC transverse'
set output
