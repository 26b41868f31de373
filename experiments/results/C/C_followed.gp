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
set output 'C_followed.svg'
set label '(d)' at screen 0.015, screen 0.96 left front
set key maxcols 3 width -2
set xlabel 'cycles followed'
set ylabel 'critical size  [grains]'
set logscale x
set format x '10^{%T}'
set mxtics 10
set logscale y
unset mytics
set ytics (2,5,10,20,50)
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series1 << EOD
300,10,,
EOD
$series2 << EOD
1,71.4450469,,
2,23.4506787,,7.24327711
5,22.609413,,4.46022855
10,20.3396832,,4.19456641
15,17.0763791,,4.09550292
20,17.8985122,,3.8116672
40,13.624595,,5.12614089
300,2.31468466,,5.2840233
EOD
$series3 << EOD
300,10,,
EOD
$series4 << EOD
1,16.7818022,,1.46061146
2,15.3734742,,2.15059039
5,15.8257886,,3.25911445
10,13.653019,,2.91831759
15,12.2027313,,3.56369028
20,9.50243397,,3.56454507
40,7.07419967,,2.31776305
EOD
$series5 << EOD
40,13,,
EOD
$series6 << EOD
1,22.0689078,,2.28825855
2,18.5974895,,1.67138222
5,16.5017088,,1.66379486
10,13.6496639,,1.52096941
15,8.9072644,,2.41140476
20,8.17457525,,2.1414965
40,1.30907007,,
EOD
$series7 << EOD
15,16,,
EOD
$series8 << EOD
1,25.3343502,,3.79479167
2,23.4208772,,2.88214647
5,20.5169367,,5.56789424
10,3.52189341,,0.745971387
15,1.50873593,,0.174633958
20,1.27045304,,0.171850196
EOD
$series9 << EOD
1,20,,
EOD
plot keyentry with linespoints lc rgb '#cc79a7' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.04', \
     keyentry with points lc rgb '#cc79a7' lw 1.2 pt 4 ps 1.1 notitle, \
     keyentry with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.05', \
     keyentry with points lc rgb '#000000' lw 1.2 pt 6 ps 1.1 notitle, \
     keyentry with linespoints lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 title '{/:Italic A} = 0.0667', \
     keyentry with points lc rgb '#009e73' lw 1.2 pt 8 ps 1.1 notitle, \
     keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 title '{/:Italic A} = 0.0833', \
     keyentry with points lc rgb '#0072b2' lw 1.2 pt 10 ps 1.1 notitle, \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 13 ps 0.4 title '{/:Italic A} = 0.1', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 12 ps 1.1 notitle, \
     $series9 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 12 ps 1.1 notitle, \
     $series8 every 1 using 1:($2-$4>0?$2-$4:1.09860284):(0):($2+$4-($2-$4>0?$2-$4:1.09860284)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series8 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 13 ps 0.4 notitle, \
     $series7 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 10 ps 1.1 notitle, \
     $series6 every 1 using 1:($2-$4>0?$2-$4:1.09860284):(0):($2+$4-($2-$4>0?$2-$4:1.09860284)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series6 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 notitle, \
     $series5 every 1 using 1:2 with points lc rgb '#009e73' lw 1.2 pt 8 ps 1.1 notitle, \
     $series4 every 1 using 1:($2-$4>0?$2-$4:1.09860284):(0):($2+$4-($2-$4>0?$2-$4:1.09860284)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#009e73' lw 0.7 notitle, \
     $series4 every 1 using 1:2 with linespoints lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 notitle, \
     $series3 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 6 ps 1.1 notitle, \
     $series2 every 1 using 1:($2-$4>0?$2-$4:1.09860284):(0):($2+$4-($2-$4>0?$2-$4:1.09860284)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#cc79a7' lw 1.2 pt 4 ps 1.1 notitle
set output
