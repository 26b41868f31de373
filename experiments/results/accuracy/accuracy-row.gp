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
set output 'accuracy-row.svg'
data = 'accuracy-row.csv'
set title 'Waves in a row of grains: worst of their frequencies' font ',12'
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
1.75117761,0.000164936115,,
0.875588806,0.000660626901,,
0.370441418,0.00372133755,,
0.275185053,0.00679954533,,
0.219597673,0.010792374,,
0.137592527,0.0288368968,,
0.0963147687,0.0645405656,,
0.0802623072,0.102089769,,
EOD
$series1 << EOD
7.00471045,1.28202271e-09,,
3.50235522,1.52326639e-08,,
1.48176567,4.72765736e-07,,
1.10074021,1.55090618e-06,,
0.87839069,3.81866308e-06,,
0.550370107,2.45926016e-05,,
0.385259075,0.000100537892,,
0.321049229,0.000203595877,,
EOD
$series2 << EOD
7.00471045,1.30491741e-07,,
3.50235522,2.07567519e-06,,
1.48176567,6.31148309e-05,,
1.10074021,0.000201864834,,
0.87839069,0.000480955918,,
0.550370107,0.00267417245,,
0.385259075,0.00812402077,,
0.321049229,0.0119442079,,
EOD
plot $series0 using 1:2 with linespoints lc rgb '#000000' pt 7 ps 0.6 title 'engine', \
     $series1 using 1:2 with linespoints lc rgb '#1f4fd8' pt 9 ps 0.6 title 'PEFRL', \
     $series2 using 1:2 with linespoints lc rgb '#2ca02c' pt 11 ps 0.6 title 'Runge-Kutta'
set output
