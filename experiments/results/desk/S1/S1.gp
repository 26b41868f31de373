set terminal svg size 325,275 enhanced font 'Helvetica,10.67' background '#ffffff'
set encoding utf8
set datafile separator ','
set border 15 lw 0.8
set xtics in mirror scale 0.9,0.5
set ytics in mirror scale 0.9,0.5
set mxtics 2
set mytics 2
set autoscale noextend
set key above horizontal center noautotitle Left reverse samplen 1.2 spacing 0.9
set output 'S1.svg'
set key maxcols 1 width -6
set xlabel 'mean overlap  ⟨{/:Italic δ}⟩  [{/:Italic d}]'
set ylabel 'volume fraction {/:Italic ϕ}, {/:Italic ϕ}_{u}'
set logscale x
set format x '10^{%T}'
set mxtics 10
set ytics 0.002
set format y '%.3f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.00349100257,0.63733514,,0.0003149677
0.00233039917,0.638552788,,0.000534835711
0.00151283412,0.639122325,,0.0005906298
0.000959570916,0.639211942,,0.000452580709
0.000567356213,0.639132626,,0.000444840019
0.000331659743,0.63917473,,0.000376232887
0.00019166056,0.639184622,,0.000346062573
0.000111272018,0.639155413,,0.000320131486
6.46746484e-05,0.639155032,,0.00029050795
EOD
$series1 << EOD
0.00349100257,0.649193195,,0.000318155705
0.00233039917,0.646409944,,0.000528185471
0.00151283412,0.64421413,,0.000713895484
0.000959570916,0.642419696,,0.000615351706
0.000567356213,0.641012023,,0.000498071083
0.000331659743,0.640257928,,0.000395685076
0.00019166056,0.639811262,,0.000360977828
0.000111272018,0.639519524,,0.000320941186
6.46746484e-05,0.639366591,,0.000293400876
EOD
$series2 << EOD
0.00247293971,0.637714697,,0.000334335653
0.00158580262,0.638258205,,0.000348913935
0.000997509983,0.638541384,,0.000330604135
0.000585293347,0.638933684,,0.000254860552
0.000359871296,0.638940817,,0.000249779143
0.000198584662,0.63898984,,0.000307157983
0.000117246216,0.63900883,,0.00029828257
6.59775684e-05,0.638912729,,0.000357873204
3.77550046e-05,0.638906085,,0.000364857691
EOD
$series3 << EOD
0.00247293971,0.646090873,,0.000547731951
0.00158580262,0.643648332,,0.000361966798
0.000997509983,0.641906104,,0.000437642528
0.000585293347,0.640891618,,0.00032468887
0.000359871296,0.640134996,,0.000287651823
0.000198584662,0.639645287,,0.000279647383
0.000117246216,0.639393489,,0.000284230004
6.59775684e-05,0.639128526,,0.000351163427
3.77550046e-05,0.639028922,,0.000362450719
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic P} at the top, {/:Italic ϕ}', \
     keyentry with linespoints lc rgb '#000000' lw 1.2 pt 6 ps 0.4 title '{/:Italic P} at the top, phi u', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title '{/:Italic P} on the moving wall, {/:Italic ϕ}', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic P} on the moving wall, phi u', \
     $series3 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series2 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series3 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle
set output
