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
set output 'walls_a.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set xlabel 'shear cycle  {/:Italic n}'
set ylabel 'volume fraction  {/:Italic ϕ}'
set ytics 0.005
set format y '%.3f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0,0.638421942,,0.000509941255
1,0.638776017,,0.000330141067
2,0.639731302,,0.000211770724
3,0.640671482,,0.000387059389
4,0.641089585,,0.000183264549
5,0.641577332,,0.000156789822
6,0.641663898,,0.000251716194
7,0.642253048,,7.53661784e-05
8,0.642450673,,0.000521834909
9,0.642702516,,0.000354268116
10,0.643146507,,0.000529426881
11,0.643127286,,0.000520516857
12,0.643367608,,0.000467910858
13,0.643136304,,0.000280856587
14,0.643547231,,0.000419328231
15,0.643905177,,0.000170414234
16,0.643864007,,0.000223415526
17,0.64386958,,0.000232955702
18,0.644357098,,0.000229254294
19,0.644437105,,0.000202066058
20,0.644333825,,0.000387189332
21,0.644676306,,0.000514399143
22,0.644850807,,0.000680917247
23,0.645153341,,0.000827882954
24,0.64533147,,0.000912369991
25,0.645659892,,0.000919947044
26,0.646112943,,0.000885245239
27,0.646833546,,0.00109637346
28,0.647857688,,0.00163241686
29,0.649155339,,0.00262029855
30,0.65090104,,0.00402026292
31,0.654378697,,0.00675674627
EOD
$series1 << EOD
0,0.636674411,,0.00044454481
1,0.6383904,,0.000192648936
2,0.64007791,,0.000532207967
3,0.644450228,,0.00182880459
4,0.65035027,,0.00352244361
5,0.659430698,,0.00750414245
EOD
$series2 << EOD
31,0.646792827,,
32,0.646222787,,
33,0.64690376,,
34,0.646803408,,
35,0.646407699,,
36,0.647144144,,
37,0.647616577,,
38,0.647397968,,
39,0.64807052,,
40,0.648400097,,
41,0.648235476,,
42,0.650215981,,
43,0.650979627,,
44,0.652676246,,
45,0.654437237,,
46,0.657275994,,
47,0.662288351,,
48,0.670247139,,
EOD
$series3 << EOD
31,0.648486499,,
32,0.648366409,,
33,0.648666538,,
34,0.648912816,,
35,0.649623485,,
36,0.650731376,,
37,0.650438991,,
38,0.651497462,,
39,0.65135231,,
40,0.651860689,,
41,0.65270497,,
42,0.654010281,,
43,0.655308782,,
44,0.656768898,,
45,0.660713446,,
46,0.662961908,,
47,0.666048596,,
48,0.666257439,,
49,0.667159259,,
50,0.669094893,,
51,0.670163951,,
EOD
$series4 << EOD
5,0.648568756,,
6,0.653771526,,
7,0.660175564,,
8,0.668301124,,
EOD
$series5 << EOD
5,0.655892271,,
6,0.671403857,,
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
