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
set ytics 10
set format y '%.0f'
set xrange [*:*]
set yrange [0:*]
set offsets graph 0.03, graph 0.03, graph 0.05, 0
$series0 << EOD
0,0.0304209354,,0.00610049024
1,0.0121904795,,0.00609373586
2,0.0243827228,,0.00386668546
3,0.0335474018,,0.00873940556
4,0.030528975,,0.00773061376
5,0.0396094376,,0.0136934957
6,0.0640205532,,0.0210141619
7,0.042678152,,0.0154117918
8,0.0975585237,,0.0234489337
9,0.0701802558,,0.0252058987
10,0.0672024596,,0.0324000784
11,0.0762886915,,0.0228509942
12,0.0854505674,,0.0365057602
13,0.155748174,,0.081804705
14,0.204433372,,0.119002378
15,0.244030446,,0.143409398
16,0.23508602,,0.151899007
17,0.310760886,,0.22494756
18,0.56698943,,0.324823633
19,0.651738844,,0.433475141
20,1.17259566,,0.840954646
21,1.49843471,,1.02722861
22,1.8638053,,1.32005897
23,2.20207725,,1.55167519
24,2.9973658,,1.95264317
25,4.18016363,,2.75747663
26,6.25482229,,3.95407249
EOD
$series1 << EOD
0,0.0483493191,,0.0213009113
1,0.314710743,,0.130298403
2,1.32500653,,0.428383424
3,4.46165055,,1.28074701
4,7.94952908,,1.96554615
5,15.1419332,,3.39987841
EOD
$series2 << EOD
26,0.329609962,,
27,0.366703337,,
28,0.43972151,,
29,0.54894785,,
30,0.804240541,,
31,1.46708234,,
32,2.74172912,,
33,4.44160117,,
34,5.65693431,,
35,6.99287931,,
36,9.04779278,,
37,14.1401274,,
38,15.3622662,,
39,17.3108329,,
40,19.7895882,,
41,20.1560232,,
EOD
$series3 << EOD
26,0.238051639,,
27,0.421322587,,
28,0.566520468,,
29,0.712719298,,
30,1.38762096,,
31,1.51515152,,
32,2.62965668,,
33,3.81804896,,
34,5.49972593,,
35,5.47845142,,
36,6.59119956,,
37,7.51276441,,
38,8.55167394,,
39,9.18850073,,
40,9.83069361,,
41,10.6518572,,
42,12.0131052,,
43,12.6681207,,
44,14.67006,,
45,15.1889535,,
46,16.0159797,,
47,17.0868855,,
48,17.7527682,,
49,18.6173108,,
50,19.5152831,,
51,20.3187251,,
EOD
$series4 << EOD
26,4.09506399,,
27,5.105215,,
28,6.43274854,,
29,9.4629156,,
30,11.1313869,,
31,12.630042,,
32,13.2762703,,
33,16.9701384,,
34,19.0701053,,
35,20.2614379,,
EOD
$series5 << EOD
26,1.00566831,,
27,0.821617674,,
28,1.460387,,
29,1.40716374,,
30,1.57249954,,
31,1.40742095,,
32,1.9915951,,
33,2.02517789,,
34,2.995981,,
35,3.55774494,,
36,4.9425497,,
37,5.6345733,,
38,7.06739526,,
39,6.12579763,,
40,7.24558529,,
41,8.01019479,,
42,7.99927114,,
43,9.03119869,,
44,9.26838168,,
45,9.43430657,,
46,10.0875593,,
47,10.0893997,,
48,10.8438126,,
49,11.0060033,,
50,10.7188353,,
51,11.7689925,,
52,12.358937,,
53,12.3340004,,
54,13.9196802,,
55,14.919135,,
56,15.7990535,,
57,17.2238372,,
58,17.6545455,,
59,18.1818182,,
60,18.7590975,,
61,18.8600472,,
62,19.4484761,,
63,20.2864394,,
EOD
$series6 << EOD
26,6.48875891,,
27,9.78816654,,
28,10.9001278,,
29,12.329017,,
30,16.6241342,,
31,25.1951352,,
EOD
$series7 << EOD
5,12.055814,,
6,17.150838,,
7,23.5326895,,
EOD
$series8 << EOD
5,18.9690339,,
6,42.9018597,,
EOD
$series9 << EOD
5,6.70515925,,
6,10.3905812,,
7,30.547818,,
EOD
$series10 << EOD
5,5.78635015,,
6,9.78281047,,
7,12.4186652,,
8,19.0714949,,
9,25.1393534,,
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
