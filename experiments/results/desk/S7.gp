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
set output 'S7.svg'
data = 'S7.csv'
set xlabel '{/:Italic x}/{/:Italic w},  {/:Italic y}/{/:Italic h}'
set ylabel 'probability density  {/:Italic P}'
set xrange [0:1]
set yrange [0:*]
plot data using (($2+$3)/2):(strcol(1) eq 'x/w' ? column(4) : NaN):5 with yerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     data using (($2+$3)/2):(strcol(1) eq 'x/w' ? column(4) : NaN) with points lc rgb '#000000' pt 4 ps 0.7 title '{/:Italic P}({/:Italic x}/{/:Italic w})', \
     data using (($2+$3)/2):(strcol(1) eq 'y/h' ? column(4) : NaN):5 with yerrorbars lc rgb '#d62728' lw 0.8 pt 0 notitle, \
     data using (($2+$3)/2):(strcol(1) eq 'y/h' ? column(4) : NaN) with points lc rgb '#d62728' pt 6 ps 0.7 title '{/:Italic P}({/:Italic y}/{/:Italic h})'
set output
