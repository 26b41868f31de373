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
set output 'S7_heights.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set key maxcols 2 width -3
set xlabel 'position  {/:Italic y}/{/:Italic h},  {/:Italic y}/1.675 {/:Italic L}'
set ylabel 'probability density  {/:Italic P}'
set xtics 0.2
set format x '%.1f'
set ytics 0.5
set format y '%.1f'
set xrange [0:1]
set yrange [*:*]
set offsets 0, 0, graph 0.05, graph 0.05
$series0 << EOD
0.0625,0.02124834,,0.028047503
0.1875,1.05179283,,0.154680324
0.3125,1.86985392,,0.274588575
0.4375,1.4873838,,0.58963634
0.5625,1.15803453,,0.109816148
0.6875,1.43426295,,0.454200187
0.8125,0.924302789,,0.363929652
0.9375,0.0531208499,,0.056238198
EOD
$series1 << EOD
0.0625,0.02124834,,0.028047503
0.1875,1.09428951,,0.154827205
0.3125,1.88047809,,0.243819839
0.4375,1.6998672,,0.553570211
0.5625,1.33864542,,0.348463387
0.6875,1.13678619,,0.33385297
0.8125,0.807436919,,0.356376559
0.9375,0.02124834,,0.0207872507
EOD
plot keyentry with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 title '{/:Italic P}({/:Italic y}/{/:Italic h})', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 title '{/:Italic P}({/:Italic y}/1.675 {/:Italic L})', \
     $series1 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 6 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4):(0):($2+$4-($2-$4)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#000000' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#000000' lw 1.2 pt 4 ps 0.4 notitle
set output
