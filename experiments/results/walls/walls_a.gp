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
set output 'walls_a.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set key maxcols 2 width -3
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'volume fraction  {/:Italic ϕ}'
set ytics 0.01
set format y '%.2f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0,0.638228537,,0.00017394021
1,0.638986372,,6.12526665e-05
2,0.640257421,,0.000168175025
3,0.640409768,,0.000305539688
4,0.64130536,,0.000277163159
5,0.641523508,,0.000181855005
6,0.641733943,,0.000255250465
7,0.642523462,,0.000211723383
8,0.642530885,,0.000288779031
9,0.642753338,,0.000166633073
10,0.643165918,,0.000171463982
11,0.643518243,,5.39034269e-05
12,0.643717963,,0.00011041801
13,0.644056937,,0.000151485572
14,0.644340989,,0.000182155178
15,0.644774964,,0.00026346162
16,0.644911497,,0.000249704937
17,0.645094526,,0.000299776686
18,0.645313191,,0.000525998223
19,0.645984472,,0.000630534863
20,0.64628911,,0.000600097479
21,0.647032747,,0.000973043293
22,0.646870937,,0.00116975136
23,0.647442578,,0.0013073623
24,0.648157943,,0.00193675408
25,0.649011771,,0.00219603285
26,0.649917061,,0.00228662641
27,0.650681852,,0.00270728974
28,0.651231823,,0.00294361441
EOD
$series1 << EOD
0,0.636740855,,0.000535872909
1,0.638523791,,0.00051308363
2,0.641888774,,0.00144880397
3,0.648965986,,0.0036025656
EOD
$series2 << EOD
28,0.647305049,,
29,0.648019921,,
30,0.649487006,,
31,0.651319882,,
32,0.651600539,,
33,0.653565646,,
34,0.655386515,,
35,0.66007301,,
EOD
$series3 << EOD
28,0.646613487,,
29,0.647208129,,
30,0.646770609,,
31,0.647653879,,
32,0.648088317,,
33,0.648787767,,
34,0.648494845,,
35,0.649302045,,
36,0.648990812,,
37,0.648752254,,
38,0.648629183,,
39,0.649281891,,
40,0.649845159,,
41,0.650098339,,
42,0.651174686,,
43,0.651363661,,
44,0.651863157,,
45,0.653135343,,
46,0.653691604,,
47,0.654802416,,
48,0.656202515,,
49,0.658018027,,
50,0.659002282,,
51,0.661165404,,
52,0.661732265,,
53,0.664941028,,
EOD
$series4 << EOD
28,0.651637047,,
29,0.652979799,,
30,0.653578593,,
31,0.655203122,,
32,0.656823264,,
33,0.657655916,,
34,0.659548991,,
35,0.661622171,,
36,0.662893355,,
37,0.665441954,,
38,0.667836021,,
EOD
$series5 << EOD
28,0.650032875,,
29,0.64949697,,
30,0.650178016,,
31,0.651292211,,
32,0.651090505,,
33,0.651569942,,
34,0.651968036,,
35,0.652100108,,
36,0.652591013,,
37,0.652734185,,
38,0.653394105,,
39,0.654259704,,
40,0.653945646,,
41,0.65388192,,
42,0.655139196,,
43,0.654863297,,
44,0.654947884,,
45,0.655691519,,
46,0.655951597,,
47,0.657330683,,
48,0.657789161,,
49,0.658235597,,
50,0.658544352,,
51,0.6597216,,
52,0.660981744,,
53,0.662582344,,
54,0.662539887,,
55,0.66319505,,
56,0.662805569,,
57,0.664148155,,
58,0.664359243,,
59,0.664476441,,
60,0.664814505,,
61,0.665426013,,
62,0.667030194,,
63,0.666179002,,
64,0.667324813,,
65,0.666503273,,
66,0.66733838,,
67,0.667641065,,
68,0.667284011,,
69,0.668200949,,
70,0.668154167,,
71,0.667944744,,
72,0.667444509,,
73,0.667882754,,
74,0.667957824,,
75,0.66848781,,
76,0.668781582,,
77,0.669373395,,
78,0.669662905,,
EOD
$series6 << EOD
28,0.646467557,,
29,0.646894757,,
30,0.646275328,,
31,0.646794255,,
32,0.648185769,,
33,0.647625519,,
34,0.647567041,,
35,0.648995256,,
36,0.648997768,,
37,0.651189052,,
38,0.651655401,,
39,0.653684552,,
40,0.656256,,
41,0.658321143,,
42,0.659861974,,
43,0.661854137,,
44,0.669969258,,
EOD
$series7 << EOD
3,0.65005773,,
4,0.67318242,,
EOD
$series8 << EOD
3,0.641602581,,
4,0.644256805,,
5,0.649295488,,
6,0.663772142,,
7,0.679148706,,
EOD
$series9 << EOD
3,0.645974362,,
4,0.653811876,,
5,0.665569614,,
EOD
$series10 << EOD
3,0.643742708,,
4,0.646619408,,
5,0.651393313,,
6,0.658174348,,
7,0.662703819,,
8,0.667211581,,
9,0.669672844,,
10,0.670441843,,
11,0.671165394,,
12,0.672141358,,
13,0.672234725,,
14,0.672672984,,
15,0.673913249,,
16,0.674619873,,
17,0.675025018,,
18,0.67540451,,
EOD
$series11 << EOD
3,0.646391427,,
4,0.657323119,,
5,0.674307633,,
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
