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
1,-0.271572405,,0.192263281
2,-0.0830710561,,0.289009914
3,0.0309689945,,0.352737633
4,0.11156837,,0.391214062
5,0.173144554,,0.405412182
6,0.222492228,,0.407507665
7,0.263354358,,0.407857749
8,0.298008418,,0.406351347
9,0.327940166,,0.403966071
10,0.354170404,,0.401401486
15,0.449797304,,0.385898279
20,0.512048285,,0.374889457
25,0.55693146,,0.36211741
30,0.591352849,,0.351033903
35,0.618873098,,0.341114666
40,0.641547776,,0.331011994
45,0.660660999,,0.322065286
50,0.677063278,,0.314061468
55,0.691343993,,0.306838139
60,0.703926574,,0.300269602
EOD
$series1 << EOD
1,-0.348643006,,0.0427153266
2,0.25,,0.126339335
3,0.155555556,,0.142727743
4,0.2,,0.185713532
5,0.76,,0.134270662
6.4807407,0.5625,,0.143399859
8.53539992,0.8,,0.143113573
10.5098419,0.130434783,,0.194698979
14.0734834,0.4,,0.194239721
19.1598505,0.3,,0.200609922
25.9532294,0.727272727,,0.149071198
36.110355,0.272727273,,0.193649167
59.3948352,0.714285714,,0.154740265
92.8654013,0.2,,0.20503893
120.487956,0.5,,0.185728698
195.559317,0.9,,0.119887359
370.000433,1,,0.0832545311
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
