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
set output 'S7.svg'
set label '(a)' at screen 0.015, screen 0.96 left front
set xlabel 'position  {/:Italic x}/{/:Italic w},  {/:Italic y}/{/:Italic h}'
set ylabel 'probability density  {/:Italic P}'
set xtics 0.2
set format x '%.1f'
set ytics 0.5
set format y '%.1f'
set xrange [0:1]
set yrange [0:*]
set offsets 0, 0, graph 0.05, 0
$series0 << EOD
0.025,0,,0
0.075,0,,0
0.125,0,,0
0.175,0.661157025,,0.496436138
0.225,0.743801653,,0.239764222
0.275,1.15702479,,0.450775704
0.325,1.81818182,,0.550867754
0.375,2.0661157,,0.966920045
0.425,2.0661157,,0.862430358
0.475,0.826446281,,0.398147304
0.525,1.65289256,,0.350073942
0.575,1.23966942,,0.442033536
0.625,1.48760331,,0.507377301
0.675,1.90082645,,0.656073773
0.725,2.0661157,,0.78728557
0.775,1.40495868,,0.561948131
0.825,0.909090909,,0.666697065
0.875,0,,0
0.925,0,,0
0.975,0,,0
EOD
$series1 << EOD
0.025,0,,0
0.075,0.165289256,,0.147677763
0.125,1.65289256,,0.498529486
0.175,1.65289256,,0.465709977
0.225,1.07438017,,0.461124031
0.275,1.23966942,,0.763965272
0.325,1.23966942,,0.516990665
0.375,0.909090909,,0.425212772
0.425,2.39669421,,1.02447532
0.475,0.743801653,,0.392723738
0.525,0.991735537,,0.559349795
0.575,1.57024793,,0.724180403
0.625,1.73553719,,0.594200968
0.675,0.495867769,,0.334494149
0.725,1.15702479,,0.641622884
0.775,0.578512397,,0.441327435
0.825,0.247933884,,0.153403638
0.875,2.14876033,,0.742843295
0.925,0,,0
0.975,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic P}({/:Italic x}/{/:Italic w})', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic P}({/:Italic y}/{/:Italic h})', \
     $series1 every 1 using 1:2:4 with yerrorbars lc rgb '#d55e00' lw 0.7 pt 0 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
