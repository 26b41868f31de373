set terminal svg size 325,230 enhanced font 'Helvetica,10.67' background '#ffffff'
set encoding utf8
set datafile separator ','
set border 15 lw 0.8
set xtics in mirror scale 0.9,0.5
set ytics in mirror scale 0.9,0.5
set mxtics 2
set mytics 2
set autoscale noextend
set key above horizontal center noautotitle Left reverse samplen 1.2 spacing 0.9
set bars 0.5
set output 'S6_overlap.svg'
set label '(e)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'mean overlap  ⟨{/:Italic δ}⟩  [{/:Italic d}]'
set xtics 0.002
set format x '%.3f'
set ytics 5e-05
set format y '%.5f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from 0.645, graph 0 to 0.645, graph 1 nohead dt 2 lc rgb '#888888'
set arrow from 0.647, graph 0 to 0.647, graph 1 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.639214617,0.00295151392,8.47893771e-05,2.47547361e-05
0.641173288,0.00313663256,6.46063844e-05,1.60982669e-05
0.643159675,0.00314625782,5.84412669e-05,1.64408286e-05
0.645052782,0.00313788272,0.000103867978,1.82644784e-05
0.646587962,0.00309345876,8.60929802e-05,1.161558e-05
0.648418294,0.00308063953,,
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 4 ps 0.4 title '{/:Italic A} = 0.05, no gravity', \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 4 ps 0.4 notitle
set output
