set terminal svg size 325,230 enhanced font 'Helvetica,10.67' background '#ffffff'
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
set output 'walls_c.svg'
set label '(c)' at screen 0.015, screen 0.96 left front
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'percentage crystalline  [%]'
set xtics 0.01
set format x '%.2f'
set ytics 5
set format y '%.0f'
set xrange [*:*]
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
$series0 << EOD
0.637503724,0.088365243,,
0.639088033,0.0229966683,0.000164847099,0.0118534516
0.641194009,0.0558140172,0.000167985719,0.0131766314
0.643109172,0.0461303462,6.7809872e-05,0.0162860551
0.644791979,0.438085427,0.0001211103,0.312544932
0.646921277,1.23332196,0.000120293094,0.600916964
0.64868554,2.48807743,0.000232299425,0.921182361
0.65096544,4.39074459,0.000184473286,1.45081391
0.652690608,4.61561745,1.43618288e-05,0.132244533
0.654484934,9.18402281,9.02432305e-05,2.70699546
0.657022446,11.159357,0.000253548196,2.82356909
0.658872383,18.6745214,,
0.660713446,11.7525773,,
0.662625129,16.5877662,0.000336778336,1.8317403
0.667172598,24.5365477,0.000684166436,6.98107539
0.669094893,19.7183099,,
0.670205545,24.6304393,4.15942081e-05,4.03272471
EOD
$series1 << EOD
0.636674411,0.0583747237,0.00044454481,0.0168008807
0.638826445,0.94402034,0.000106717722,0.0936094697
0.641138342,1.84743743,,
0.642634881,3.98928006,0.00038355854,0.631181989
0.645084914,5.55389669,,
0.648526417,8.57637525,0.000245896777,0.369376678
0.653771526,12.2613365,,
0.655892271,16.3728712,,
0.657036323,12.1841155,,
0.660175564,19.9224575,,
0.668301124,22.265046,,
0.671403857,23.9689181,,
0.673831069,23.8779174,,
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'rough walls', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title 'smooth walls', \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
