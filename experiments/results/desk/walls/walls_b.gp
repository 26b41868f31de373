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
set output 'walls_b.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'percentage crystalline  [%]'
set ytics 5
set format y '%.0f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0,0.029455081,,0.029455081
1,0.0493185187,,0.0355990025
2,0.00986777186,,0.00986777186
3,0.0789306267,,0.00987980606
4,0.0494120233,,0.0261563644
5,0.0395442584,,0.0261635468
6,0.0593619251,,0.0171650823
7,0.0493710174,,0.0261286688
8,0.0395063864,,0.00981514257
9,0.0394389863,,0.0260938761
10,0.0692179219,,0.0261751691
11,0.0494621229,,0.0261410709
12,0.0197444086,,0.00987227736
13,0.0594412569,,0.0343252261
14,0.0789248773,,0.0198144361
15,0.039515078,,0.00985461634
16,0.0592127003,,8.18570554e-05
17,0.0695065038,,0.0695065038
18,0.267068949,,0.222921802
19,0.346473954,,0.331773736
20,0.36613315,,0.336529628
21,0.473734936,,0.416001789
22,0.45445024,,0.396834924
23,0.464247907,,0.375845643
24,0.730078049,,0.686049133
25,1.00678509,,0.785160151
26,1.48024839,,1.09580303
27,1.51005978,,1.36233728
28,2.81926015,,2.14771278
29,5.26940772,,4.65304082
30,6.6786335,,5.99880987
31,11.1064187,,10.2127996
EOD
$series1 << EOD
0,0.0583747237,,0.0168008807
1,0.541308994,,0.275390443
2,1.59851425,,0.169027635
3,5.40048389,,1.45749551
4,9.01763869,,1.91974177
5,16.147373,,4.52973107
EOD
$series2 << EOD
31,0.236826525,,
32,0.296384114,,
33,0.14858841,,
34,0.474918373,,
35,0.297265161,,
36,0.474214582,,
37,0.355450237,,
38,0.679468242,,
39,0.798816568,,
40,0.858242083,,
41,1.66320166,,
42,1.60237389,,
43,2.66508736,,
44,4.48337292,,
45,5.99881797,,
46,13.9829261,,
47,18.4195065,,
48,28.663164,,
EOD
$series3 << EOD
31,1.56480661,,
32,1.77357375,,
33,1.44713526,,
34,2.39220319,,
35,3.43703704,,
36,3.248671,,
37,3.89725421,,
38,4.01416765,,
39,4.08042578,,
40,4.45953928,,
41,4.74786199,,
42,6.08747045,,
43,7.88308237,,
44,8.33578792,,
45,11.7525773,,
46,14.7560259,,
47,17.1311235,,
48,17.0244046,,
49,18.5108888,,
50,19.7183099,,
51,20.5977146,,
EOD
$series4 << EOD
5,8.19133034,,
6,12.2613365,,
7,19.9224575,,
8,22.265046,,
EOD
$series5 << EOD
5,16.3728712,,
6,23.9689181,,
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'rough walls', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title 'smooth walls', \
     keyentry with lines lc rgb '#000000' lw 0.6 notitle, \
     keyentry with lines lc rgb '#000000' lw 0.6 notitle, \
     keyentry with lines lc rgb '#d55e00' lw 0.6 notitle, \
     keyentry with lines lc rgb '#d55e00' lw 0.6 notitle, \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series5 using 1:2 with lines lc rgb '#d55e00' lw 0.6 notitle, \
     $series4 using 1:2 with lines lc rgb '#d55e00' lw 0.6 notitle, \
     $series3 using 1:2 with lines lc rgb '#000000' lw 0.6 notitle, \
     $series2 using 1:2 with lines lc rgb '#000000' lw 0.6 notitle, \
     $series1 using 1:2 with lines lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series1 every 2 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 using 1:2 with lines lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle, \
     $series0 every 2 using 1:2 with points lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
