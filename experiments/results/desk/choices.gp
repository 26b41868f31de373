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
set output 'choices.svg'
data = 'choices.csv'
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'volume fraction  {/:Italic ϕ}'
plot data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=10;wall_drag_grains_per_d2_s=1000;wall_grain_draw=0' ? column(3) : NaN):4 with yerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=10;wall_drag_grains_per_d2_s=1000;wall_grain_draw=0' ? column(3) : NaN) with linespoints lc rgb '#000000' pt 5 ps 0.6 title 'default', \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=30;wall_drag_grains_per_d2_s=1000;wall_grain_draw=0' ? column(3) : NaN):4 with yerrorbars lc rgb '#d62728' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=30;wall_drag_grains_per_d2_s=1000;wall_grain_draw=0' ? column(3) : NaN) with linespoints lc rgb '#d62728' pt 9 ps 0.6 title 'wall mass ×3', \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=3.333333333333333;wall_drag_grains_per_d2_s=1000;wall_grain_draw=0' ? column(3) : NaN):4 with yerrorbars lc rgb '#d62728' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=3.333333333333333;wall_drag_grains_per_d2_s=1000;wall_grain_draw=0' ? column(3) : NaN) with linespoints lc rgb '#d62728' pt 8 ps 0.6 title 'wall mass /3', \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=10;wall_drag_grains_per_d2_s=3000;wall_grain_draw=0' ? column(3) : NaN):4 with yerrorbars lc rgb '#1f4fd8' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=10;wall_drag_grains_per_d2_s=3000;wall_grain_draw=0' ? column(3) : NaN) with linespoints lc rgb '#1f4fd8' pt 11 ps 0.6 title 'wall drag ×3', \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=10;wall_drag_grains_per_d2_s=333.3333333333333;wall_grain_draw=0' ? column(3) : NaN):4 with yerrorbars lc rgb '#1f4fd8' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=10;wall_drag_grains_per_d2_s=333.3333333333333;wall_grain_draw=0' ? column(3) : NaN) with linespoints lc rgb '#1f4fd8' pt 10 ps 0.6 title 'wall drag /3', \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=10;wall_drag_grains_per_d2_s=1000;wall_grain_draw=1' ? column(3) : NaN):4 with yerrorbars lc rgb '#2ca02c' lw 0.8 pt 0 notitle, \
     data using 2:(strcol(1) eq 'wall_mass_grains_per_d2=10;wall_drag_grains_per_d2_s=1000;wall_grain_draw=1' ? column(3) : NaN) with linespoints lc rgb '#2ca02c' pt 7 ps 0.6 title 'other wall grains'
set output
