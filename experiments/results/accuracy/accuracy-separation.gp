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
set output 'accuracy-separation.svg'
data = 'accuracy-separation.csv'
set logscale y
set format y '10^{%T}'
set xlabel 'time  [s]'
set ylabel 'distance  [{/:Italic d}]'
plot data using (strcol(1) eq '1.1e-05' ? $3 : NaN):4 with lines lw 1.5 lc 1 title '1.1e-05 s', \
     data using (strcol(1) eq '2.6e-05' ? $3 : NaN):4 with lines lw 1.5 lc 2 title '2.6e-05 s', \
     data using (strcol(1) eq '3.43e-05' ? $3 : NaN):4 with lines lw 1.5 lc 3 title '3.43e-05 s', \
     data using (strcol(1) eq '4.39e-05' ? $3 : NaN):4 with lines lw 1.5 lc 4 title '4.39e-05 s', \
     data using (strcol(1) eq '6.85e-05' ? $3 : NaN):4 with lines lw 1.5 lc 5 title '6.85e-05 s', \
     data using (strcol(1) eq '0.000104' ? $3 : NaN):4 with lines lw 1.5 lc 6 title '0.000104 s', \
     data using (strcol(1) eq 'moved by 1e-13 d' ? $3 : NaN):4 with lines lw 1.5 lc rgb '#000000' title 'moved by 1e-13 d'
set output
