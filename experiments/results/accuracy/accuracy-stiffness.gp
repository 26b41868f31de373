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
set key above horizontal center noautotitle Left reverse samplen 1.5 width 2
set bars 0.5
set output 'accuracy-stiffness.svg'
set xlabel 'seconds per cycle of 600 sheared grains'
set ylabel 'bias of the volume fraction'
set logscale x
set xrange [*:*]
set yrange [*<0:0<*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from graph 0, first 0 to graph 1, first 0 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.219597673,0.0103905751,,0.000827499762
0.292838203,0.00745599581,,0.000845561732
0.39050602,0.00523347554,,0.000653963439
0.520748146,0.00337674402,,0.000754887859
0.694428814,0.00237195992,,0.000556539682
0.926035707,0.00115393071,,0.000370374427
1.23488846,0.000710622097,,0.000349906821
1.64675023,0.000495084852,,0.000135102539
2.19597673,0.000157978511,,1.56361458e-05
EOD
$series1 << EOD
0.219597673,0.000971850218,,0.000724962796
0.292838203,0.00100654331,,0.000608090338
0.39050602,0.00125575462,,0.000510826631
0.520748146,0.00088120626,,0.000641283294
0.694428814,0.000862660865,,0.000466858171
0.926035707,0.00030768936,,0.000377521832
1.23488846,0.00019755278,,0.000356923168
1.64675023,0.00020389845,,0.000123946986
2.19597673,0,,0
EOD
plot $series0 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     $series0 using 1:2 with points lc rgb '#000000' pt 6 ps 0.6 title '{/:Italic ϕ}_{u}', \
     $series1 using 1:2:4 with yerrorbars lc rgb '#d62728' lw 0.8 pt 0 notitle, \
     $series1 using 1:2 with points lc rgb '#d62728' pt 7 ps 0.6 title '{/:Italic ϕ} (S4)'
set output
