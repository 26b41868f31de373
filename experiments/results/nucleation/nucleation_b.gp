set terminal svg size 325,275 enhanced font 'Helvetica,10.67' background '#ffffff'
set encoding utf8
set datafile separator ','
set border 15 lw 0.8
set xtics in mirror scale 0.9,0.5
set ytics in mirror scale 0.9,0.5
set mxtics 2
set mytics 2
set autoscale noextend
set key above horizontal center noautotitle Left reverse samplen 1.2 spacing 0.9
set output 'nucleation_b.svg'
set label '(b)' at screen 0.015, screen 0.96 left front
set key maxcols 1 width -4
set xlabel 'volume fraction  {/:Italic ϕ}'
set ylabel 'onsets per grain and cycle'
set xtics 0.001
set format x '%.3f'
set logscale y
set format y '10^{%T}'
set mytics 10
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.6444,6.95237015e-07,,4.01395278e-07
0.6464,1.73542699e-06,,7.08485103e-07
EOD
$series1 << EOD
0.6448,7.63688331e-07,,4.40915663e-07
0.6468,1.39306335e-06,,4.92522269e-07
EOD
$series2 << EOD
0.6452,2.66828594e-06,,1.19329375e-06
0.6472,6.52977643e-07,,
0.6492,1.00939749e-05,,
EOD
$series3 << EOD
0.6436,1.38575938e-06,,
0.6456,2.78247019e-06,,1.3912351e-06
0.6476,2.00150113e-06,,
EOD
plot keyentry with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 title '{/:Italic A} = 0.05, {/:Italic N} = 5200', \
     keyentry with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 title '{/:Italic A} = 0.05, {/:Italic N} = 7900', \
     keyentry with points lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 title '{/:Italic A} = 0.05, {/:Italic N} = 11400', \
     keyentry with points lc rgb '#cc79a7' lw 1.2 pt 11 ps 0.4 title '{/:Italic A} = 0.05, {/:Italic N} = 18200', \
     $series3 every 1 using 1:($2-$4>0?$2-$4:2.93841737e-07):(0):($2+$4-($2-$4>0?$2-$4:2.93841737e-07)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#cc79a7' lw 0.7 notitle, \
     $series3 every 1 using 1:2 with points lc rgb '#cc79a7' lw 1.2 pt 11 ps 0.4 notitle, \
     $series2 every 1 using 1:($2-$4>0?$2-$4:2.93841737e-07):(0):($2+$4-($2-$4>0?$2-$4:2.93841737e-07)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#009e73' lw 0.7 notitle, \
     $series2 every 1 using 1:2 with points lc rgb '#009e73' lw 1.2 pt 9 ps 0.4 notitle, \
     $series1 every 1 using 1:($2-$4>0?$2-$4:2.93841737e-07):(0):($2+$4-($2-$4>0?$2-$4:2.93841737e-07)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#d55e00' lw 0.7 notitle, \
     $series1 every 1 using 1:2 with points lc rgb '#d55e00' lw 1.2 pt 7 ps 0.4 notitle, \
     $series0 every 1 using 1:($2-$4>0?$2-$4:2.93841737e-07):(0):($2+$4-($2-$4>0?$2-$4:2.93841737e-07)) with vectors heads size screen 0.00615384615,90 fixed lc rgb '#0072b2' lw 0.7 notitle, \
     $series0 every 1 using 1:2 with points lc rgb '#0072b2' lw 1.2 pt 5 ps 0.4 notitle
set output
