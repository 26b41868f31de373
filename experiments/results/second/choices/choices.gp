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
0,0.63837941,,7.37657502e-05
1,0.639166114,,6.94454137e-05
2,0.639985723,,6.00705428e-05
3,0.640587679,,9.74279225e-05
4,0.641210416,,9.30488158e-05
5,0.641545356,,0.000106798989
6,0.641912988,,9.53526077e-05
7,0.642194031,,0.000102327283
8,0.642431614,,0.000106442613
9,0.642760226,,0.000112385788
10,0.642926286,,0.000132559572
11,0.643185966,,0.000126847886
12,0.643407711,,0.000143495285
13,0.643508274,,0.000157628207
14,0.643857011,,0.0001807889
15,0.644073046,,0.000197918613
EOD
$series1 << EOD
0,0.638559967,,9.11326093e-05
1,0.639082044,,8.33891707e-05
2,0.64000235,,8.95685931e-05
3,0.64077275,,9.52630866e-05
4,0.641309935,,0.000102904473
5,0.641832937,,0.000116481267
6,0.642131998,,0.000120065372
7,0.642527546,,0.000126372394
8,0.642789312,,0.000143353782
9,0.642949485,,0.000133786071
10,0.643315645,,0.00016572686
11,0.643648881,,0.000200438723
12,0.643884076,,0.000239906259
13,0.644190577,,0.000313846893
14,0.644836771,,0.000484163921
15,0.645412391,,0.000783521003
EOD
$series2 << EOD
0,0.63846443,,0.000173371485
1,0.639053468,,8.3697579e-05
2,0.639895354,,0.000114698073
3,0.64064985,,0.000134571663
4,0.641223648,,0.000137304357
5,0.641782615,,9.43586285e-05
6,0.642092237,,0.000123903288
7,0.642266051,,0.000168274376
8,0.642743621,,0.000184754874
9,0.642903469,,0.000195653128
10,0.643018992,,0.000177284365
11,0.643239809,,0.000184401891
12,0.643859289,,0.000178429274
13,0.643836305,,0.000248832146
14,0.644322952,,0.000248998291
15,0.644780803,,0.000310263704
EOD
$series3 << EOD
0,0.637963173,,0.00022330274
1,0.638736036,,0.000611442099
2,0.640006291,,0.000400958126
3,0.640864895,,0.000635953803
4,0.64125944,,0.000749430177
5,0.641819805,,0.000736356149
6,0.64212744,,0.000754817666
7,0.64217732,,0.000479951086
8,0.642626397,,0.000101892582
9,0.64315425,,0.000488560966
10,0.643530184,,6.66144654e-05
11,0.643068192,,0.000113032324
12,0.643964594,,0.000579167359
13,0.644346602,,0.000250467226
14,0.64473832,,0.00072879726
15,0.644824887,,0.0010538179
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'default', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 9 ps 0.4 title 'wall mass ×3', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 8 ps 0.4 title 'wall mass /3', \
     keyentry with linespoints lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 title 'wall drag ×3', \
     $series3 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series2 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series3 every 1 using 1:2 with linespoints lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 notitle, \
     $series2 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 8 ps 0.4 notitle, \
     $series1 every 1 using 1:2 with linespoints lc rgb '#d55e00' lw 1.2 pt 9 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
