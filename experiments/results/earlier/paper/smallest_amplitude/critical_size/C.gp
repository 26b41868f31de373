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
set arrow from 10, graph 0 to 10, graph 0.06 nohead lw 2 lc rgb '#6a3d9a'
$series0 << EOD
1,-0.934666083,,0.0479836766
2,-0.8227333,,0.140551356
3,-0.694112759,,0.292101839
4,-0.562407633,,0.451724658
5,-0.435034179,,0.572398455
6,-0.315802888,,0.669793674
7,-0.206355052,,0.747254189
8,-0.107064985,,0.805815837
9,-0.01760672,,0.847445536
10,0.0626991054,,0.874314625
15,0.355871784,,0.935131226
20,0.531082901,,0.957193295
25,0.642200994,,0.967575832
30,0.716795072,,0.973339982
35,0.769311502,,0.976714493
40,0.807750787,,0.978857033
45,0.836796877,,0.980304223
50,0.859331067,,0.981330668
55,0.877203061,,0.982088097
60,0.891644605,,0.982665635
EOD
$series1 << EOD
1,-0.923740354,,0.0057835357
2,-0.852631579,,0.0270678398
3,-0.740112994,,0.0507939728
4,-0.890909091,,0.0670824744
5,-0.674418605,,0.112741659
6,-0.909090909,,0.11055416
7.45956071,-0.523809524,,0.179265462
9.7639682,-0.44,,0.17258737
13.3005826,0.130434783,,0.194698979
22.3214777,0.8,,0.143113573
32.7332861,1,,0.0868666442
35.5966164,1,,0.0605764606
37.791577,1,,0.0713795638
41.8107451,1,,0.0868666442
50.5746675,1,,0.0868666442
64.4735894,1,,0.0768615138
78.3757628,1,,0.0689215201
82.1681788,1,,0.0624674733
86.5227112,1,,0.0868666442
EOD
plot keyentry with lines lc rgb '#6a3d9a' lw 1.2 notitle, \
     keyentry with points lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.04', \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#6a3d9a' fs transparent solid 0.2 noborder notitle, \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#6a3d9a' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#6a3d9a' lw 1.2 pt 5 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with lines lc rgb '#6a3d9a' lw 1.2 notitle
set output
