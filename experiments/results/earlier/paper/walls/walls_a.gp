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
set ytics 0.01
set format y '%.2f'
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0,0.638795238,,0.000254733902
1,0.639588475,,7.53092e-05
2,0.640726677,,0.000164897763
3,0.641118913,,0.000226611296
4,0.641550018,,0.000177214048
5,0.641929722,,0.000159547315
6,0.642381531,,0.000220099015
7,0.642826429,,0.000168009986
8,0.642998275,,9.18182164e-05
9,0.643128215,,0.00010198096
10,0.643350565,,0.000108095475
11,0.643417335,,0.000281841379
12,0.643685086,,0.000267210939
13,0.643910527,,0.00031100023
14,0.644044937,,0.000343844572
15,0.644516256,,0.000262585771
16,0.644525072,,0.000252106453
17,0.644976155,,0.000235754912
18,0.645371226,,0.000324135984
19,0.645548748,,0.00036122476
20,0.646152293,,0.000473833332
21,0.646622422,,0.000698602218
22,0.646904821,,0.000890354209
23,0.647527985,,0.00119733183
24,0.64798725,,0.00137366756
25,0.649331657,,0.0021038212
26,0.651139056,,0.00333382291
EOD
$series1 << EOD
0,0.637038072,,0.000151388135
1,0.638448936,,0.000267479659
2,0.640122849,,0.000535672132
3,0.644512869,,0.00126446762
4,0.649569246,,0.00205283895
5,0.656803533,,0.00317885875
EOD
$series2 << EOD
26,0.647981896,,
27,0.64816577,,
28,0.648930182,,
29,0.649464062,,
30,0.649683172,,
31,0.650576049,,
32,0.650857333,,
33,0.651842339,,
34,0.652842803,,
35,0.654784983,,
36,0.655654005,,
37,0.658240083,,
38,0.659678865,,
39,0.661678375,,
40,0.664370303,,
41,0.665148172,,
EOD
$series3 << EOD
26,0.646188788,,
27,0.646854929,,
28,0.647252291,,
29,0.648014091,,
30,0.64852818,,
31,0.648684132,,
32,0.649019192,,
33,0.6496745,,
34,0.651153998,,
35,0.652083743,,
36,0.652823428,,
37,0.654356379,,
38,0.655207541,,
39,0.655816905,,
40,0.656294413,,
41,0.656988519,,
42,0.658090481,,
43,0.658908511,,
44,0.660037921,,
45,0.660465129,,
46,0.661097103,,
47,0.662024503,,
48,0.662905342,,
49,0.664458243,,
50,0.664637322,,
51,0.665829225,,
EOD
$series4 << EOD
26,0.647692193,,
27,0.648207258,,
28,0.649018519,,
29,0.650925206,,
30,0.652501405,,
31,0.654340447,,
32,0.655092063,,
33,0.658079681,,
34,0.660722089,,
35,0.663234486,,
EOD
$series5 << EOD
26,0.646459846,,
27,0.646783368,,
28,0.647151687,,
29,0.647224273,,
30,0.647216304,,
31,0.647169956,,
32,0.647762969,,
33,0.647972515,,
34,0.648682088,,
35,0.648916169,,
36,0.649791617,,
37,0.650425032,,
38,0.651645352,,
39,0.651733741,,
40,0.652161225,,
41,0.653234301,,
42,0.654197592,,
43,0.654493692,,
44,0.655111561,,
45,0.65545971,,
46,0.656278543,,
47,0.655661821,,
48,0.656270364,,
49,0.656963333,,
50,0.656908038,,
51,0.657579199,,
52,0.65823527,,
53,0.659260776,,
54,0.660628815,,
55,0.662167066,,
56,0.663568691,,
57,0.665086442,,
58,0.665866084,,
59,0.667186252,,
60,0.667740992,,
61,0.667913066,,
62,0.668042206,,
63,0.669389972,,
EOD
$series6 << EOD
26,0.651088213,,
27,0.653442064,,
28,0.65556406,,
29,0.656789227,,
30,0.659909354,,
31,0.665690744,,
EOD
$series7 << EOD
5,0.651003347,,
6,0.657825383,,
7,0.664111696,,
EOD
$series8 << EOD
5,0.663696821,,
6,0.684214593,,
EOD
$series9 << EOD
5,0.649327133,,
6,0.657006681,,
7,0.677461921,,
EOD
$series10 << EOD
5,0.648878832,,
6,0.653454405,,
7,0.657915932,,
8,0.665750375,,
9,0.676346175,,
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
     $series1 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
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
     $series1 every 2 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 using 1:2 with lines lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle, \
     $series0 every 2 using 1:2 with points lc rgb '#000000' lw 1.2 pt 5 ps 0.4 notitle
set output
