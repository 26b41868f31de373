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
set output 'accuracy-cage.svg'
data = 'accuracy-cage.csv'
set title 'One grain swings in a cage: position, in amplitudes' font ',12'
set xlabel 'seconds per cycle of 600 sheared grains'
set ylabel 'relative error'
set logscale x
set format x '10^{%T}'
set mxtics 10
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
1.75117761,0.00176057515,,
0.875588806,0.00704731488,,
0.370441418,0.0395512806,,
0.275185053,0.0719284164,,
0.219597673,0.113402518,,
0.137592527,0.291089026,,
0.0963147687,0.590801758,,
0.0802623072,0.803518734,,
EOD
$series1 << EOD
7.00471045,5.04463819e-09,,
3.50235522,8.06808377e-08,,
1.48176567,2.51745218e-06,,
1.10074021,8.26463265e-06,,
0.87839069,2.03442382e-05,,
0.550370107,0.000131726865,,
0.385259075,0.000545185538,,
0.321049229,0.00112320685,,
EOD
$series2 << EOD
7.00471045,6.96189324e-07,,
3.50235522,1.11447275e-05,,
1.48176567,0.00034865338,,
1.10074021,0.00114633582,,
0.87839069,0.00282160473,,
0.550370107,0.0182635201,,
0.385259075,0.0731085998,,
0.321049229,0.141899379,,
EOD
plot $series0 using 1:2 with linespoints lc rgb '#000000' pt 7 ps 0.6 title 'engine', \
     $series1 using 1:2 with linespoints lc rgb '#1f4fd8' pt 9 ps 0.6 title 'PEFRL', \
     $series2 using 1:2 with linespoints lc rgb '#2ca02c' pt 11 ps 0.6 title 'Runge-Kutta'
set output
