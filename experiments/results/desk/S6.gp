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
set output 'S6.svg'
data = 'S6.csv'
set yrange [*<0.6445:0.6475<*]
set arrow from graph 0, first 0.645 to graph 1, first 0.645 nohead dt 2 lc rgb '#888888'
set arrow from graph 0, first 0.647 to graph 1, first 0.647 nohead dt 2 lc rgb '#888888'
set label '' at 19.7659933,0.645401914 point pt 7 ps 1 lc rgb '#000000' front
set label '' at 22.0216751,0.645490676 point pt 7 ps 1 lc rgb '#000000' front
set label '' at 21.3909035,0.646488893 point pt 7 ps 1 lc rgb '#000000' front
set label '' at 17.786352,0.645915238 point pt 7 ps 1 lc rgb '#000000' front
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'volume fraction  {/:Italic ϕ}'
plot data using 2:(strcol(1) eq 'gravity_m_per_s2=9.81;amplitude_rad=0.0833' && int(column(2)) % 2 == 0 ? column(3) : NaN):4 with yerrorbars lc rgb '#1f4fd8' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=9.81;amplitude_rad=0.0833' ? column(3) : NaN) with lines lc rgb '#1f4fd8' notitle, \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=9.81;amplitude_rad=0.0833' && int(column(2)) % 2 == 0 ? column(3) : NaN) with points lc rgb '#1f4fd8' pt 5 ps 0.6 title '{/:Italic A} = 0.0833, gravity', \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=0;amplitude_rad=0.0833' && int(column(2)) % 2 == 0 ? column(3) : NaN):4 with yerrorbars lc rgb '#1f4fd8' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=0;amplitude_rad=0.0833' ? column(3) : NaN) with lines lc rgb '#1f4fd8' notitle, \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=0;amplitude_rad=0.0833' && int(column(2)) % 2 == 0 ? column(3) : NaN) with points lc rgb '#1f4fd8' pt 4 ps 0.6 title '{/:Italic A} = 0.0833, no gravity', \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=9.81;amplitude_rad=0.1' && int(column(2)) % 2 == 0 ? column(3) : NaN):4 with yerrorbars lc rgb '#d62728' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=9.81;amplitude_rad=0.1' ? column(3) : NaN) with lines lc rgb '#d62728' notitle, \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=9.81;amplitude_rad=0.1' && int(column(2)) % 2 == 0 ? column(3) : NaN) with points lc rgb '#d62728' pt 7 ps 0.6 title '{/:Italic A} = 0.1, gravity', \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=0;amplitude_rad=0.1' && int(column(2)) % 2 == 0 ? column(3) : NaN):4 with yerrorbars lc rgb '#d62728' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=0;amplitude_rad=0.1' ? column(3) : NaN) with lines lc rgb '#d62728' notitle, \
     data using 2:(strcol(1) eq 'gravity_m_per_s2=0;amplitude_rad=0.1' && int(column(2)) % 2 == 0 ? column(3) : NaN) with points lc rgb '#d62728' pt 6 ps 0.6 title '{/:Italic A} = 0.1, no gravity'
set output
