set terminal svg size 325,245 enhanced font 'Helvetica,10.67' background '#ffffff'
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
set ytics 0.0002
set format y '%.4f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from 0.645, graph 0 to 0.645, graph 1 nohead dt 2 lc rgb '#888888'
set arrow from 0.647, graph 0 to 0.647, graph 1 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.637626936,0.00362208663,,
0.639026719,0.00384704183,7.90757288e-05,2.97328966e-05
0.641189349,0.00411320035,7.33517251e-05,2.44416278e-05
0.643196496,0.00411816874,3.69207526e-05,1.72598625e-05
0.645100116,0.0041226277,0.000106082504,2.97164769e-05
0.646467249,0.00405429799,0.000116787062,3.17601557e-05
0.648107174,0.00401621754,,
EOD
$series1 << EOD
0.639214617,0.00295151392,8.47893771e-05,2.47547361e-05
0.641173288,0.00313663256,6.46063844e-05,1.60982669e-05
0.643159675,0.00314625782,5.84412669e-05,1.64408286e-05
0.645052782,0.00313788272,0.000103867978,1.82644784e-05
0.646587962,0.00309345876,8.60929802e-05,1.161558e-05
0.648418294,0.00308063953,,
EOD
plot keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.05, gravity', \
     keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 4 ps 0.4 title '{/:Italic A} = 0.05, no gravity', \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 4 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
