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
set output 'C_followed.svg'
set label '(d)' at screen 0.015, screen 0.96 left front
set xlabel 'cycles that crystallites are followed'
set ylabel 'critical size  [grains]'
set logscale x
set format x '10^{%T}'
set mxtics 10
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*<7.5:22.5<*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from graph 0, first 10 to graph 1, first 10 nohead dt 2 lc rgb '#6a3d9a'
set arrow from graph 0, first 13 to graph 1, first 13 nohead dt 2 lc rgb '#000000'
set arrow from graph 0, first 16 to graph 1, first 16 nohead dt 2 lc rgb '#009e73'
set arrow from graph 0, first 20 to graph 1, first 20 nohead dt 2 lc rgb '#0072b2'
$series0 << EOD
1,30.1356558,,2.65471437
2,30.4390823,,2.17969037
5,26.9532983,,1.89937031
10,23.8163267,,2.51800283
20,19.5837957,,1.93644965
300,5.45361754,,12.194609
EOD
$series1 << EOD
1,38.8615156,,6.02271878
2,33.0725454,,10.4141484
5,38.0205047,,15.3413091
10,28.2281981,,12.0829074
20,30.6743458,,31.6528919
40,15.6943971,,4.47256795
EOD
$series2 << EOD
1,28.0802292,,6.4458995
2,29.2449829,,9.93554969
5,25.2039762,,14.4975349
10,17.1634211,,18.2605154
15,6.51165426,,7.82417801
20,3.43187847,,2.84160211
EOD
$series3 << EOD
1,21.7726754,,3.61340304
2,17.0744087,,2.4015585
5,11.271004,,4.92820253
10,5.14222254,,1.92074811
20,4.71877712,,115.996578
EOD
plot keyentry with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.05', \
     keyentry with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.0667', \
     keyentry with linespoints lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 title '{/:Italic A} = 0.0833', \
     keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 title '{/:Italic A} = 0.1', \
     $series3 every 1 using 1:2:4 with yerrorbars lc rgb '#0072b2' lw 0.7 pt 0 notitle, \
     $series3 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 notitle, \
     $series2 every 1 using 1:2:4 with yerrorbars lc rgb '#009e73' lw 0.7 pt 0 notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 notitle, \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#6a3d9a' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 notitle
set output
