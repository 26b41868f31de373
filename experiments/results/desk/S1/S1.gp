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
set key maxcols 1 width -9
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
0.00349100257,0.649193195,1.25568039e-05,0.000318155705
0.00233039917,0.646409944,4.25806809e-05,0.000528185471
0.00151283412,0.64421413,5.21725944e-05,0.000713895484
0.000959570916,0.642419696,4.8013251e-05,0.000615351706
0.000567356213,0.641012023,1.49846111e-05,0.000498071083
0.000331659743,0.640257928,2.03196774e-05,0.000395685076
0.00019166056,0.639811262,7.99423928e-06,0.000360977828
0.000111272018,0.639519524,4.01866144e-06,0.000320941186
6.46746484e-05,0.639366591,1.95613145e-06,0.000293400876
EOD
$series1 << EOD
0.00349100257,0.63733514,1.25568039e-05,0.0003149677
0.00233039917,0.638552788,4.25806809e-05,0.000534835711
0.00151283412,0.639122325,5.21725944e-05,0.0005906298
0.000959570916,0.639211942,4.8013251e-05,0.000452580709
0.000567356213,0.639132626,1.49846111e-05,0.000444840019
0.000331659743,0.63917473,2.03196774e-05,0.000376232887
0.00019166056,0.639184622,7.99423928e-06,0.000346062573
0.000111272018,0.639155413,4.01866144e-06,0.000320131486
6.46746484e-05,0.639155032,1.95613145e-06,0.00029050795
EOD
$series2 << EOD
0.00247293971,0.646090873,6.43448326e-05,0.000547731951
0.00158580262,0.643648332,2.90881894e-05,0.000361966798
0.000997509983,0.641906104,2.9595822e-05,0.000437642528
0.000585293347,0.640891618,2.24879574e-05,0.00032468887
0.000359871296,0.640134996,1.19292064e-05,0.000287651823
0.000198584662,0.639645287,8.38423833e-06,0.000279647383
0.000117246216,0.639393489,4.21125631e-06,0.000284230004
6.59775684e-05,0.639128526,2.38917844e-06,0.000351163427
3.77550046e-05,0.639028922,1.04550577e-06,0.000362450719
EOD
$series3 << EOD
0.00247293971,0.637714697,6.43448326e-05,0.000334335653
0.00158580262,0.638258205,2.90881894e-05,0.000348913935
0.000997509983,0.638541384,2.9595822e-05,0.000330604135
0.000585293347,0.638933684,2.24879574e-05,0.000254860552
0.000359871296,0.638940817,1.19292064e-05,0.000249779143
0.000198584662,0.63898984,8.38423833e-06,0.000307157983
0.000117246216,0.63900883,4.21125631e-06,0.00029828257
6.59775684e-05,0.638912729,2.38917844e-06,0.000357873204
3.77550046e-05,0.638906085,1.04550577e-06,0.000364857691
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 6 ps 0.4 title '{/:Italic ϕ}_{u}, uncorrected', \
     keyentry with points lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic ϕ}', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic ϕ}_{u}, uncorrected, P on the moving wall', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title '{/:Italic ϕ}, P on the moving wall', \
     $series3 every 1 using ($1-$3>0?$1-$3:3.67094988e-05):2:($1+$3-($1-$3>0?$1-$3:3.67094988e-05)):(0) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series3 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series3 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series2 every 1 using ($1-$3>0?$1-$3:3.67094988e-05):2:($1+$3-($1-$3>0?$1-$3:3.67094988e-05)):(0) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series2 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series2 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series1 every 1 using ($1-$3>0?$1-$3:3.67094988e-05):2:($1+$3-($1-$3>0?$1-$3:3.67094988e-05)):(0) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using ($1-$3>0?$1-$3:3.67094988e-05):2:($1+$3-($1-$3>0?$1-$3:3.67094988e-05)):(0) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series0 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 6 ps 0.4 notitle
set output
