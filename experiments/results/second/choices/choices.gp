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
set output 'choices.svg'
set key maxcols 2 width -3
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'volume fraction  {/:Italic ϕ}'
set ytics 0.002
set format y '%.3f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0,0.638382751,,0.000107347296
1,0.639195856,,0.000112289286
2,0.640043498,,9.36901184e-05
3,0.640601315,,0.000130536612
4,0.641270465,,0.000133481743
5,0.641616878,,0.00015796805
6,0.641999831,,0.000135678368
7,0.642214069,,0.000150326225
8,0.642494124,,0.000118591148
9,0.64281,,0.000142177746
10,0.642967469,,0.000166365628
11,0.643183502,,0.000155643053
12,0.643457385,,0.000153648274
13,0.643597381,,0.000200079645
14,0.644001586,,0.000220459276
15,0.644131043,,0.000203465364
EOD
$series1 << EOD
0,0.638436572,,0.000123495076
1,0.638831189,,0.000105082226
2,0.640090272,,0.000144174947
3,0.640973122,,0.000144062
4,0.641462493,,0.000146384733
5,0.641982596,,0.000162817188
6,0.642166621,,0.000188129782
7,0.642593674,,0.00021376511
8,0.642901785,,0.000218464941
9,0.642904662,,0.000204529419
10,0.643416004,,0.000281659959
11,0.643877567,,0.000339795549
12,0.644114783,,0.000434162804
13,0.644589601,,0.00059125011
14,0.645488459,,0.000930348136
15,0.646477581,,0.00152344198
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'default', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 9 ps 0.4 title 'wall mass ×3', \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 9 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
