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
set output 'accuracy-collision-speed.svg'
set title 'Two grains collide: speed after it' font ',12'
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
1.75117761,0.000130079677,,
0.875588806,0.0004707847,,
0.370441418,0.000982826359,,
0.275185053,0.0013261736,,
0.219597673,0.00549755628,,
0.137592527,0.023246028,,
0.0963147687,0.0347843473,,
0.0802623072,0.0276345749,,
EOD
$series1 << EOD
7.00471045,4.53405148e-05,,
3.50235522,0.000185611413,,
1.48176567,0.000432158567,,
1.10074021,0.00116620363,,
0.87839069,0.00230669604,,
0.550370107,0.00732423704,,
0.385259075,0.0103353179,,
0.321049229,0.0212105901,,
EOD
$series2 << EOD
7.00471045,4.99486536e-05,,
3.50235522,0.000200015136,,
1.48176567,0.00038099117,,
1.10074021,0.00105904382,,
0.87839069,0.00224974297,,
0.550370107,0.00789517437,,
0.385259075,0.0120940084,,
0.321049229,0.0241544227,,
EOD
plot $series0 using 1:2 with linespoints lc rgb '#000000' pt 7 ps 0.6 title 'engine', \
     $series1 using 1:2 with linespoints lc rgb '#1f4fd8' pt 9 ps 0.6 title 'PEFRL', \
     $series2 using 1:2 with linespoints lc rgb '#2ca02c' pt 11 ps 0.6 title 'Runge-Kutta'
set output
