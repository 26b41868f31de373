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
set output 'accuracy-wall.svg'
set title 'One grain swings on a wall: position, in amplitudes' font ',12'
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
1.75117761,0.000816926902,,
0.875588806,0.00326984655,,
0.370441418,0.0183084242,,
0.275185053,0.0332566795,,
0.219597673,0.0523152792,,
0.137592527,0.134340228,,
0.0963147687,0.276115012,,
0.0802623072,0.399823128,,
EOD
$series1 << EOD
7.00471045,1.18156504e-09,,
3.50235522,1.87083314e-08,,
1.48176567,5.8368168e-07,,
1.10074021,1.91688655e-06,,
0.87839069,4.72203319e-06,,
0.550370107,3.0615774e-05,,
0.385259075,0.000127124205,,
0.321049229,0.000262984885,,
EOD
$series2 << EOD
7.00471045,1.61465594e-07,,
3.50235522,2.58505226e-06,,
1.48176567,8.07833684e-05,,
1.10074021,0.000265610366,,
0.87839069,0.000654921131,,
0.550370107,0.00425732409,,
0.385259075,0.0176369307,,
0.321049229,0.0360846553,,
EOD
plot $series0 using 1:2 with linespoints lc rgb '#000000' pt 7 ps 0.6 title 'engine', \
     $series1 using 1:2 with linespoints lc rgb '#1f4fd8' pt 9 ps 0.6 title 'PEFRL', \
     $series2 using 1:2 with linespoints lc rgb '#2ca02c' pt 11 ps 0.6 title 'Runge-Kutta'
set output
