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
set output 'committor.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set key maxcols 3 width -2
set xlabel 'crystallite size  [grains]'
set ylabel 'share that grows'
set xtics 5
set format x '%.0f'
set ytics 0.2
set format y '%.1f'
set xrange [0:21]
set yrange [0:1]
set offsets 0, 0, 0, 0
set arrow from graph 0, first 0.5 to graph 1, first 0.5 nohead dt 2 lc rgb '#888888'
set arrow from graph 0, first 0 to graph 1, first 0 nohead dt 2 lc rgb '#000000'
set arrow from graph 0, first 0 to graph 1, first 0 nohead dt 2 lc rgb '#009e73'
set arrow from graph 0, first 0.0416666667 to graph 1, first 0.0416666667 nohead dt 2 lc rgb '#0072b2'
set arrow from graph 0, first 0.78125 to graph 1, first 0.78125 nohead dt 2 lc rgb '#d55e00'
$series0 << EOD
3,-1.7214008e-12,,1.27115741e-12
4,1.33673028e-08,,1.36086555e-08
5,1.09954778e-05,,8.00785035e-06
8,0.0196445434,,0.0267139329
9,0.121578644,,0.116139819
13,0.467522261,,0.467685202
15,0.151252733,,0.654372554
EOD
$series1 << EOD
3,0,,0.0664963812
4.61030863,0,,0.0712169308
9.65476415,0.333333333,,0.244031726
EOD
$series2 << EOD
3,0.00582252981,,0.00848788514
4,0.119218232,,0.134738885
5,0.0529179329,,0.0691463113
6,0.0232522891,,0.0303281191
8,0.0668822654,,0.0841537521
9,0.193017357,,0.107517978
10,0.357553921,,0.130641354
12,0.645951048,,0.167689223
13,0.748395931,,0.16610416
14,0.81938301,,0.151243744
15,0.869804803,,0.143220913
16,0.911838431,,0.164751528
17,0.952877637,,0.214585085
EOD
$series3 << EOD
3,0,,0.0587085273
4,0.2,,0.292715546
5,0,,0.0829882663
7.39632159,0,,0.0712169308
10.7383255,0.416666667,,0.236844295
14.2372438,0.9,,0.118387808
EOD
$series4 << EOD
3,-0.00128080645,,0.00199326759
4,0.0336629774,,0.021819536
5,0.139090884,,0.066665703
6,0.301127027,,0.109933096
7,0.531306385,,0.129334915
8,0.737728964,,0.115224713
9,0.850976685,,0.087192388
10,0.906521792,,0.059824583
11,0.939470201,,0.0401774297
12,0.962274299,,0.0277943294
13,0.979041386,,0.0188966064
15,0.997109199,,0.0067587775
17,1.00141385,,0.0018958682
18,1.00168681,,0.00144874854
EOD
$series5 << EOD
3,0,,0.0416272656
4,0,,0.0554593554
5.51576888,0.0769230769,,0.0849836586
7,0.583333333,,0.225259793
8.73885189,1,,0.0664963812
12.0503223,0.941176471,,0.0686231832
15,1,,0.0904534034
17.7954014,1,,0.0766555176
EOD
$series6 << EOD
3,0.299709081,,0.118080923
4,0.342336047,,0.0996381005
5,0.427650747,,0.0986778002
6,0.590862599,,0.101043711
7,0.71508225,,0.0873853532
8,0.793143872,,0.0754944014
9,0.842774797,,0.0668650948
10,0.878548022,,0.0552734092
12,0.93156868,,0.0332053776
13,0.949744597,,0.029047994
14,0.963741445,,0.0278518722
15,0.975231188,,0.0254767291
16,0.985851001,,0.0197489081
17,0.996427624,,0.0118309584
18,1.00693208,,0.0101508901
EOD
$series7 << EOD
3,0.3,,0.118752555
4,0.333333333,,0.19340822
5,0.36,,0.154319129
6,0.615384615,,0.244558279
7.52184661,0.923076923,,0.0849836586
9.72888933,0.826086957,,0.0971127587
13.4761883,0.954545455,,0.0663486373
15.3261886,1,,0.0829882663
17.3570406,1,,0.0712169308
EOD
plot keyentry with lines lc rgb '#000000' lw 1.2 notitle, \
     keyentry with points lc rgb '#000000' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.05', \
     keyentry with lines lc rgb '#009e73' lw 1.2 notitle, \
     keyentry with points lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 title '{/:Italic A} = 0.0667', \
     keyentry with lines lc rgb '#0072b2' lw 1.2 notitle, \
     keyentry with points lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 title '{/:Italic A} = 0.0833', \
     keyentry with lines lc rgb '#d55e00' lw 1.2 notitle, \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 13 ps 0.4 title '{/:Italic A} = 0.1', \
     $series6 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#d55e00' fs transparent solid 0.2 noborder notitle, \
     $series4 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#0072b2' fs transparent solid 0.2 noborder notitle, \
     $series2 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#009e73' fs transparent solid 0.2 noborder notitle, \
     $series0 using 1:($2-$4):($2+$4) with filledcurves fc rgb '#000000' fs transparent solid 0.2 noborder notitle, \
     $series7 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series7 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 13 ps 0.4 notitle, \
     $series6 every 1 using 1:2 with lines lc rgb '#d55e00' lw 1.2 notitle, \
     $series5 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series5 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 11 ps 0.4 notitle, \
     $series4 every 1 using 1:2 with lines lc rgb '#0072b2' lw 1.2 notitle, \
     $series3 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#009e73' lw 0.7 notitle, \
     $series3 every 1 using 1:2 with points lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 notitle, \
     $series2 every 1 using 1:2 with lines lc rgb '#009e73' lw 1.2 notitle, \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:2 with lines lc rgb '#000000' lw 1.2 notitle
set output
