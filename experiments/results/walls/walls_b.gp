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
set output 'walls_b.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set key maxcols 2 width -3
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'percentage crystalline  [%]'
set ytics 5
set format y '%.0f'
set xrange [*:*]
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
$series0 << EOD
0,0.0393314385,,0.0124445685
1,0.0296034916,,0.0108192947
2,0.0345973897,,0.0141796244
3,0.0148206962,,0.00662802859
4,0.0296384608,,0.0108320639
5,0.0295974862,,0.0152893533
6,0.00987803286,,0.00624742897
7,0.0246841517,,0.00910497631
8,0.0148118936,,0.0101161665
9,0.0592140231,,0.0264646116
10,0.0937089238,,0.0454459968
11,0.286521128,,0.143979489
12,0.301488529,,0.178723504
13,0.271524562,,0.123666211
14,0.330760659,,0.169767071
15,0.276636909,,0.150870886
16,0.424723582,,0.19829983
17,0.607396395,,0.329230514
18,0.926925111,,0.595614257
19,1.40513403,,0.935285303
20,1.68659844,,1.11186266
21,2.30125872,,1.6668728
22,2.47200553,,1.72358385
23,2.77384168,,1.88278847
24,3.5111903,,2.34913742
25,4.17970826,,2.80758746
26,4.26359782,,2.73632057
27,4.89211444,,3.07174018
28,5.48326435,,3.41010746
EOD
$series1 << EOD
0,0.0340733405,,0.0175674477
1,0.774028464,,0.4345
2,3.30831852,,1.6222754
3,7.3873707,,2.98753549
EOD
$series2 << EOD
28,0.976042591,,
29,2.68436578,,
30,6.60961936,,
31,7.43143615,,
32,8.13439434,,
33,7.9009434,,
34,12.9487934,,
35,23.3598117,,
EOD
$series3 << EOD
28,0.20746888,,
29,0.385756677,,
30,0.623145401,,
31,0.710900474,,
32,0.237529691,,
33,0.442477876,,
34,0.385756677,,
35,0.621301775,,
36,0.681885562,,
37,0.860534125,,
38,1.12726194,,
39,0.921248143,,
40,1.01010101,,
41,1.92649674,,
42,1.80740741,,
43,2.52001186,,
44,4.83823093,,
45,5.03703704,,
46,5.76070901,,
47,6.93419888,,
48,9.50279494,,
49,11.6539141,,
50,13.0997939,,
51,14.5918967,,
52,15.3394064,,
53,23.0318993,,
EOD
$series4 << EOD
28,5.84070796,,
29,7.24808486,,
30,9.56881276,,
31,10.8554572,,
32,12.2346698,,
33,12.1399177,,
34,14.0505585,,
35,15.6793398,,
36,17.1218796,,
37,17.8174371,,
38,21.3889699,,
EOD
$series5 << EOD
28,2.36686391,,
29,2.86558346,,
30,2.83855707,,
31,3.63690124,,
32,3.59563808,,
33,3.98465171,,
34,4.43655723,,
35,4.54948301,,
36,4.66489519,,
37,5.32072125,,
38,5.26783072,,
39,5.95343354,,
40,5.94642331,,
41,6.9808542,,
42,7.48898678,,
43,7.14285714,,
44,6.94935218,,
45,8.97058824,,
46,9.76470588,,
47,12.0035305,,
48,11.5882353,,
49,12.0046962,,
50,13.0703562,,
51,14.6176471,,
52,13.847967,,
53,14.3360752,,
54,15.2358629,,
55,15.636896,,
56,16.5148398,,
57,17.1847507,,
58,16.3247362,,
59,16.4764413,,
60,16.0714286,,
61,16.4231444,,
62,17.6298891,,
63,17.2262774,,
64,18.080749,,
65,17.6039836,,
66,17.4053419,,
67,18.4318315,,
68,19.3510669,,
69,17.834209,,
70,18.3649635,,
71,18.3386955,,
72,17.7556402,,
73,18.4079602,,
74,19.0824079,,
75,19.2622951,,
76,18.9584552,,
77,19.1172172,,
78,20.3454333,,
EOD
$series6 << EOD
28,1.45314353,,
29,1.48500149,,
30,0.977488152,,
31,1.50932228,,
32,2.28418867,,
33,2.34630235,,
34,2.01183432,,
35,2.78271166,,
36,3.61267397,,
37,4.7829938,,
38,5.19174041,,
39,7.32783991,,
40,9.12032951,,
41,10.5726872,,
42,12.5110132,,
43,15.2224824,,
44,28.7591241,,
EOD
$series7 << EOD
3,5.00749625,,
4,20.8646052,,
EOD
$series8 << EOD
3,1.3963161,,
4,2.3297491,,
5,5.32896695,,
6,15.8004779,,
7,28.8095238,,
EOD
$series9 << EOD
3,6.95443645,,
4,12.4324324,,
5,23.0053989,,
EOD
$series10 << EOD
3,3.15599639,,
4,4.296875,,
5,7.68537977,,
6,13.0460802,,
7,13.3989854,,
8,14.7453083,,
9,14.0309156,,
10,14.7784716,,
11,15.028215,,
12,15.1677056,,
13,14.6544052,,
14,14.45962,,
15,14.0824192,,
16,12.9251701,,
17,13.7400059,,
18,21.1698337,,
EOD
$series11 << EOD
3,6.05789317,,
4,15.1849642,,
5,32.1811681,,
EOD
plot keyentry with linespoints lc rgb '#000000' lw 1.2 pt 5 ps 0.4 title 'rough walls', \
     keyentry with linespoints lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title 'smooth walls', \
     keyentry with lines lc rgb '#000000' lw 0.6 notitle, \
     keyentry with lines lc rgb '#000000' lw 0.6 notitle, \
     keyentry with lines lc rgb '#000000' lw 0.6 notitle, \
     keyentry with lines lc rgb '#000000' lw 0.6 notitle, \
     keyentry with lines lc rgb '#000000' lw 0.6 notitle, \
     keyentry with lines lc rgb '#d55e00' lw 0.6 notitle, \
     keyentry with lines lc rgb '#d55e00' lw 0.6 notitle, \
     keyentry with lines lc rgb '#d55e00' lw 0.6 notitle, \
     keyentry with lines lc rgb '#d55e00' lw 0.6 notitle, \
     keyentry with lines lc rgb '#d55e00' lw 0.6 notitle, \
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series11 using 1:2 with lines lc rgb '#d55e00' lw 0.6 notitle, \
     $series10 using 1:2 with lines lc rgb '#d55e00' lw 0.6 notitle, \
     $series9 using 1:2 with lines lc rgb '#d55e00' lw 0.6 notitle, \
     $series8 using 1:2 with lines lc rgb '#d55e00' lw 0.6 notitle, \
     $series7 using 1:2 with lines lc rgb '#d55e00' lw 0.6 notitle, \
     $series6 using 1:2 with lines lc rgb '#000000' lw 0.6 notitle, \
     $series5 using 1:2 with lines lc rgb '#000000' lw 0.6 notitle, \
     $series4 using 1:2 with lines lc rgb '#000000' lw 0.6 notitle, \
     $series3 using 1:2 with lines lc rgb '#000000' lw 0.6 notitle, \
     $series2 using 1:2 with lines lc rgb '#000000' lw 0.6 notitle, \
     $series1 using 1:2 with lines lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series1 every 5 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 using 1:2 with lines lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle, \
     $series0 every 5 using 1:2 with points lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
