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
set output 'S7_stiffness.svg'
set label '(c)' at screen 0.015, screen 0.96 left front
set xlabel 'position  {/:Italic y}/{/:Italic h}'
set ylabel 'probability density  {/:Italic P}'
set xtics 0.2
set format x '%.1f'
set ytics 0.5
set format y '%.1f'
set xrange [0:1]
set yrange [*:*]
set offsets 0, 0, graph 0.05, graph 0.05
$series0 << EOD
0.025,0,,0
0.075,0,,0
0.125,1.32947977,,0.349618086
0.175,2.08092486,,0.623958776
0.225,1.04046243,,0.40081195
0.275,0.867052023,,0.246508402
0.325,0.924855491,,0.357765965
0.375,0.751445087,,0.182943445
0.425,1.96531792,,0.580457083
0.475,1.56069364,,0.35473567
0.525,1.21387283,,0.291922587
0.575,1.04046243,,0.306311956
0.625,1.50289017,,0.459551762
0.675,0.693641618,,0.21292952
0.725,1.0982659,,0.469453587
0.775,0.751445087,,0.291043344
0.825,1.79190751,,0.64500223
0.875,1.2716763,,0.364979357
0.925,0.115606936,,0.122516548
0.975,0,,0
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic k} = 654 N/m', \
     $series0 every 1 using 1:2:4 with yerrorbars lc rgb '#000000' lw 0.7 pt 0 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
