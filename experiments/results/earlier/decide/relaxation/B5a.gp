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
set output 'B5a.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'volume fraction  {/:Italic ϕ}'
set ytics 0.001
set format y '%.3f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0,0.638717437,,4.87761473e-05
1,0.639357979,,5.0951646e-05
2,0.640446318,,5.26924262e-05
3,0.641021854,,5.21780573e-05
4,0.641500121,,6.33138663e-05
5,0.641959534,,5.17013797e-05
6,0.642276337,,5.92018463e-05
7,0.642569844,,6.85193277e-05
8,0.64290199,,7.1594192e-05
9,0.643127229,,6.95694205e-05
10,0.643463544,,8.63763155e-05
11,0.643642712,,0.000102472062
12,0.644045369,,0.000114383381
13,0.644368447,,0.000139443839
14,0.644650703,,0.000169920552
15,0.644954552,,0.000191899894
EOD
$series1 << EOD
0,0.638717437,,4.87761473e-05
1,0.640307488,,5.15177722e-05
2,0.641174147,,4.65141177e-05
3,0.641767283,,5.32083049e-05
4,0.642234109,,5.01006156e-05
5,0.642543305,,6.70197707e-05
6,0.642846853,,6.84347053e-05
7,0.643159329,,7.8064758e-05
8,0.643534636,,8.51385198e-05
9,0.643749013,,9.25820301e-05
10,0.644061284,,9.616336e-05
11,0.644395604,,0.000114635241
12,0.644616211,,0.000134448825
13,0.644962162,,0.000159783684
14,0.645281135,,0.000187329916
15,0.645707818,,0.000235927819
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'continuous shear', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title 'periodically paused shear', \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
