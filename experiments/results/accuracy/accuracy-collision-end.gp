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
set output 'accuracy-collision-end.svg'
data = 'accuracy-collision-end.csv'
set title 'Two grains collide: when it ends, in contact times' font ',12'
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
1.75117761,8.24440428e-05,,
0.875588806,0.000329955157,,
0.370441418,0.00184836641,,
0.275185053,0.00335668043,,
0.219597673,0.00529929497,,
0.137592527,0.0137914442,,
0.0963147687,0.0290410953,,
0.0802623072,0.0421962706,,
EOD
$series1 << EOD
7.00471045,2.44557914e-07,,
3.50235522,1.58790413e-06,,
1.48176567,5.52853661e-06,,
1.10074021,2.1203326e-05,,
0.87839069,5.64442319e-05,,
0.550370107,0.000401998087,,
0.385259075,0.000567833102,,
0.321049229,0.00170931848,,
EOD
$series2 << EOD
7.00471045,2.73894492e-07,,
3.50235522,1.83436997e-06,,
1.48176567,1.68408296e-05,,
1.10074021,5.50507797e-05,,
0.87839069,0.000137548935,,
0.550370107,0.000873574824,,
0.385259075,0.00275243196,,
0.321049229,0.00527221728,,
EOD
plot $series0 using 1:2 with linespoints lc rgb '#000000' pt 7 ps 0.6 title 'engine', \
     $series1 using 1:2 with linespoints lc rgb '#1f4fd8' pt 9 ps 0.6 title 'PEFRL', \
     $series2 using 1:2 with linespoints lc rgb '#2ca02c' pt 11 ps 0.6 title 'Runge-Kutta'
set output
