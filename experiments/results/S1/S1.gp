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
0.00361717667,0.638310235,,7.82933019e-05
0.00245597203,0.639143598,,6.62623105e-05
0.00152343147,0.639694652,,7.09183854e-05
0.000936968029,0.639950719,,7.40554464e-05
0.000555561829,0.640036215,,7.57657842e-05
0.000325166476,0.640106983,,7.99465496e-05
0.00018742837,0.640112121,,8.22402239e-05
0.000108385471,0.640102873,,8.77479275e-05
6.19597276e-05,0.640114071,,9.07466218e-05
EOD
$series1 << EOD
0.00361717667,0.650711604,,0.000107057245
0.00245597203,0.647553418,,7.76852281e-05
0.00152343147,0.644869345,,6.23856512e-05
0.000936968029,0.643116914,,7.06454955e-05
0.000555561829,0.641903121,,7.36289493e-05
0.000325166476,0.641194415,,7.5644618e-05
0.00018742837,0.640735836,,7.99493708e-05
0.000108385471,0.640462676,,8.65350349e-05
6.19597276e-05,0.640319124,,8.99775742e-05
EOD
$series2 << EOD
0.00219323561,0.638805193,,0.0001411561
0.00136428081,0.639278372,,0.000100894061
0.000854041247,0.639466129,,0.000135035854
0.000512500357,0.639543405,,0.00013507501
0.000298595457,0.639570038,,0.000139116799
0.000174167021,0.639599758,,0.000137697604
0.000101022971,0.639609432,,0.000135206406
5.68004369e-05,0.639668083,,0.000132201368
3.15823094e-05,0.639695589,,0.000124308359
EOD
$series3 << EOD
0.00219323561,0.646271921,,0.000121642339
0.00136428081,0.643882897,,0.000131359263
0.000854041247,0.642341846,,0.000126006449
0.000512500357,0.6412623,,0.000129318814
0.000298595457,0.640564426,,0.000140645954
0.000174167021,0.640176197,,0.000141516378
0.000101022971,0.639942627,,0.000137988338
5.68004369e-05,0.639855286,,0.000131720971
3.15823094e-05,0.63979923,,0.000125177669
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
