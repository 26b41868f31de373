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
set output 'C.svg'
data = 'C.csv'
set label '(a)' at screen 0.015, screen 0.96 left front
set xlabel 'crystallite size  [grains]'
set ylabel '{/:Italic Δρ} = {/:Italic ρ}_{g} − {/:Italic ρ}_{s}'
set xtics 10
set format x '%.0f'
set ytics 0.5
set format y '%.1f'
set xrange [0:60]
set yrange [-1.05:1.05]
set offsets 0, 0, 0, 0
set arrow from graph 0, first 0 to graph 1, first 0 nohead dt 2 lc rgb '#888888'
set arrow from 16, graph 0 to 16, graph 0.06 nohead lw 2 lc rgb '#6a3d9a'
set arrow from 20, graph 0 to 20, graph 0.06 nohead lw 2 lc rgb '#000000'
$series0 << EOD
1,-0.248575052,,0.184396001
2,-0.0260004351,,0.247706341
3,0.106889244,,0.30552403
4,0.199182226,,0.342793106
5,0.268497723,,0.366647186
6,0.323173159,,0.372238017
7,0.367791453,,0.376760845
8,0.405127403,,0.377653445
9,0.436979849,,0.376465486
10,0.464576173,,0.373356645
15,0.562468465,,0.354338262
20,0.623688013,,0.340060346
25,0.666479257,,0.327639122
30,0.698478732,,0.316928292
35,0.723525469,,0.307617548
40,0.743788295,,0.299105187
45,0.76059672,,0.291164553
50,0.774816698,,0.284064474
55,0.787039374,,0.277659864
60,0.797683707,,0.271838408
EOD
$series1 << EOD
1,-0.326086957,,0.0439562401
2,0.283018868,,0.128564869
3,0.238095238,,0.145170177
4,0.25,,0.187255575
5,0.833333333,,0.122970039
6.4807407,0.666666667,,0.135889327
8.96413508,0.785714286,,0.122108125
11.8973348,0.238095238,,0.199242422
17.4916655,0.565217391,,0.167515786
25.5836864,1,,0.0868666442
36.551159,0.4,,0.194239721
61.0585319,0.6,,0.174764355
98.057631,-0.1,,0.207650997
153.770354,0.8,,0.143113573
EOD
$series2 << EOD
1,-0.725966881,,0.137165941
2,-0.592791037,,0.151507866
3,-0.494973905,,0.155408054
4,-0.416764336,,0.155224078
5,-0.351443933,,0.157862469
6,-0.295369114,,0.159779328
7,-0.246297269,,0.159873543
8,-0.202733193,,0.162834639
9,-0.163622962,,0.1648661
10,-0.128192464,,0.166196842
15,0.0104293024,,0.172447177
20,0.108853829,,0.187660842
25,0.18385189,,0.193854487
30,0.243619323,,0.200167677
35,0.292766583,,0.205953134
40,0.334134688,,0.210883743
45,0.369591227,,0.213910414
50,0.400424984,,0.212423621
55,0.42755976,,0.210818384
60,0.451678314,,0.210119762
EOD
$series3 << EOD
1,-0.724137931,,0.0485621445
2,-0.5625,,0.143399859
3.2448562,-0.545454545,,0.173205081
6.69887819,-0.217391304,,0.192153785
13.1132716,-0.2,,0.20503893
42.9008526,0.6,,0.174764355
107.319082,0.5,,0.185728698
242.951165,0.4,,0.194239721
511.180538,0.8,,0.143113573
951.868076,0.7,,0.16084577
1225.44506,0.5,,0.185728698
1795.50263,0.4,,0.194239721
EOD
plot keyentry with lines lc rgb '#6a3d9a' lw 1.2 notitle, \
     keyentry with points lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.0833', \
     keyentry with lines lc rgb '#000000' lw 1.2 notitle, \
     keyentry with points lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.1', \
     $series2 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#6a3d9a' fs transparent solid 0.2 noborder notitle, \
     $series3 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series3 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle, \
     $series2 every 1 using 1:2 with lines lc rgb '#000000' lw 1.2 notitle, \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#6a3d9a' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with lines lc rgb '#6a3d9a' lw 1.2 notitle
set output
