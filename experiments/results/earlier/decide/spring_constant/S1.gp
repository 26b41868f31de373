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
set output 'S1.svg'
set xlabel 'mean overlap  ⟨{/:Italic δ}⟩  [{/:Italic d}]'
set ylabel 'volume fraction  {/:Italic ϕ}'
set logscale x
set format x '10^{%T}'
set mxtics 10
set ytics 0.002
set format y '%.3f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.00372496009,0.651546772,1.07143428e-05,6.85035496e-05
0.00253114184,0.648307745,8.99494668e-06,5.90672037e-05
0.00160296224,0.645588415,5.82612638e-06,5.29146505e-05
0.000976735151,0.643691112,4.49867534e-06,4.76796784e-05
0.000578253291,0.642469242,3.08075771e-06,4.31863079e-05
0.000338059757,0.641717114,1.64643023e-06,4.15713226e-05
0.000197389557,0.641260808,1.02193526e-06,4.1400079e-05
0.000113600062,0.640990008,5.03329404e-07,4.21249904e-05
6.50487953e-05,0.640827259,3.11304834e-07,4.19027134e-05
EOD
$series1 << EOD
0.00372496009,0.638720442,1.07143428e-05,4.75731189e-05
0.00253114184,0.639609898,8.99494668e-06,4.6605843e-05
0.00160296224,0.640115842,5.82612638e-06,4.58034397e-05
0.000976735151,0.640381129,4.49867534e-06,4.31462099e-05
0.000578253291,0.640522321,3.08075771e-06,4.19110247e-05
0.000338059757,0.640585119,1.64643023e-06,4.11424445e-05
0.000197389557,0.640602658,1.02193526e-06,4.14343896e-05
0.000113600062,0.640612566,5.03329404e-07,4.20613381e-05
6.50487953e-05,0.640611624,3.11304834e-07,4.1907413e-05
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 6 ps 0.4 title '{/:Italic ϕ}_{u}, uncorrected', \
     keyentry with points lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic ϕ}', \
     $series1 every 1 using 1:2:3:4 with xyerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2:3:4 with xyerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 6 ps 0.4 notitle
set output
