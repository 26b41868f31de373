set terminal svg size 325,305 enhanced font 'Helvetica,10.67' background '#ffffff'
set encoding utf8
set datafile separator ','
set border 15 lw 0.8
set xtics in mirror scale 0.9,0.5
set ytics in mirror scale 0.9,0.5
set mxtics 2
set mytics 2
set autoscale noextend
set key above horizontal center noautotitle Left reverse samplen 1.2 spacing 0.9
set output 'accuracy-order.svg'
set key maxcols 1 width -5
set xlabel 'time step  [2/ω_{max}]'
set ylabel 'relative error'
set logscale x
unset mxtics
set xtics (0.05,0.1,0.2,0.5)
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
set arrow from 0.0221683845, graph 0 to 0.0221683845, graph 1 nohead dt 2 lc rgb '#888888'
set arrow from 0.354694151, graph 0 to 0.354694151, graph 1 nohead dt 2 lc rgb '#888888'
$series0 << EOD
0.709388302,0.0259611708,,
0.501613279,0.0128415041,,
0.354694151,0.00679537881,,
0.25080664,0.00323422336,,
0.177347076,0.00164769311,,
0.12540332,0.00080944317,,
0.0886735378,0.000401094857,,
0.0627016599,0.000201580683,,
0.0443367689,0.000101713993,,
0.0313508299,5.02735476e-05,,
0.0221683845,2.53517512e-05,,
EOD
$series1 << EOD
0.709388302,0.212775342,,
0.501613279,0.105269551,,
0.354694151,0.0523152792,,
0.25080664,0.0260680675,,
0.177347076,0.013008671,,
0.12540332,0.00650079765,,
0.0886735378,0.00324772783,,
0.0627016599,0.00162346338,,
0.0443367689,0.000811599756,,
0.0313508299,0.000405770776,,
0.0221683845,0.000202871792,,
EOD
$series2 << EOD
0.709388302,0.00993178525,,
0.501613279,0.00495630392,,
0.354694151,0.00255355663,,
0.25080664,0.00126536539,,
0.177347076,0.000641339367,,
0.12540332,0.000316915998,,
0.0886735378,0.000158068107,,
0.0627016599,7.92737675e-05,,
0.0443367689,3.96746774e-05,,
0.0313508299,1.98270824e-05,,
0.0221683845,9.96399252e-06,,
EOD
$series3 << EOD
0.709388302,7.53580549e-05,,
0.501613279,1.88631506e-05,,
0.354694151,4.72203318e-06,,
0.25080664,1.1809397e-06,,
0.177347076,2.95302735e-07,,
0.12540332,7.38699133e-08,,
0.0886735378,1.84715041e-08,,
0.0627016599,4.6272414e-09,,
0.0443367689,1.16280889e-09,,
0.0313508299,2.93479896e-10,,
0.0221683845,7.9180469e-11,,
EOD
$series4 << EOD
0.709388302,0.0109041401,,
0.501613279,0.00516236973,,
0.354694151,0.0026602664,,
0.25080664,0.00131255053,,
0.177347076,0.000667974199,,
0.12540332,0.000329744944,,
0.0886735378,0.000163885737,,
0.0627016599,8.2554447e-05,,
0.0443367689,4.11467538e-05,,
0.0313508299,2.05445122e-05,,
0.0221683845,1.03737817e-05,,
EOD
$series5 << EOD
0.709388302,0.0104501208,,
0.501613279,0.0026185273,,
0.354694151,0.000654921131,,
0.25080664,0.000163537021,,
0.177347076,4.08485029e-05,,
0.12540332,1.02116426e-05,,
0.0886735378,2.5512041e-06,,
0.0627016599,6.37670958e-07,,
0.0443367689,1.59386291e-07,,
0.0313508299,3.98376938e-08,,
0.0221683845,9.96125771e-09,,
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title 'collision, engine', \
     keyentry with linespoints lc rgb '#000000' lw 1.2 dt 2 pt 6 ps 0.4 title 'wall, engine', \
     keyentry with linespoints lc rgb '#1f4fd8' lw 1.2 pt 9 ps 0.4 title 'collision, PEFRL', \
     keyentry with linespoints lc rgb '#1f4fd8' lw 1.2 dt 2 pt 8 ps 0.4 title 'wall, PEFRL', \
     keyentry with linespoints lc rgb '#2ca02c' lw 1.2 pt 11 ps 0.4 title 'collision, Runge-Kutta', \
     keyentry with linespoints lc rgb '#2ca02c' lw 1.2 dt 2 pt 10 ps 0.4 title 'wall, Runge-Kutta', \
     $series5 every 1 using 1:2 with linespoints lc rgb '#2ca02c' lw 1.2 dt 2 pt 10 ps 0.4 notitle, \
     $series4 every 1 using 1:2 with linespoints lc rgb '#2ca02c' lw 1.2 pt 11 ps 0.4 notitle, \
     $series3 every 1 using 1:2 with linespoints lc rgb '#1f4fd8' lw 1.2 dt 2 pt 8 ps 0.4 notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#1f4fd8' lw 1.2 pt 9 ps 0.4 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 dt 2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle
set output
