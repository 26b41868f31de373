set terminal svg size 600,430 enhanced font 'Helvetica,14' background '#ffffff'
set encoding utf8
set datafile separator ','
set border 15 lw 1.2
set xtics in mirror scale 0.9,0.5
set ytics in mirror scale 0.9,0.5
set format '%h'
set mxtics 2
set mytics 2
set autoscale noextend
set key above horizontal center noautotitle Left reverse samplen 1.5 width 2
set bars 0.5
set output 'S1.svg'
data = 'S1.csv'
set xlabel 'mean overlap  ⟨{/:Italic δ}⟩  [{/:Italic d}]'
set ylabel 'volume fraction  {/:Italic ϕ}'
set logscale x
set format x '10^{%T}'
set mxtics 10
set xrange [*:*]
set yrange [*:*]
set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05
$series0 << EOD
0.00207116497,0.646682539,2.51740581e-05,0.000249794782
0.00132232742,0.644626729,1.99334875e-05,0.000247255843
0.000802594212,0.643047673,1.7502e-05,0.000211036829
0.000478079047,0.642030395,1.0809614e-05,0.000201304472
0.000283663959,0.641448194,8.32740182e-06,0.00016969907
0.000165430845,0.641067167,4.8157637e-06,0.000157388662
9.59887996e-05,0.640833543,2.74758854e-06,0.000148075156
5.45245071e-05,0.640694806,1.08999671e-06,0.000145615263
3.02426394e-05,0.640602884,7.6593042e-07,0.000146855182
EOD
$series1 << EOD
0.00207116497,0.639651529,2.51740581e-05,0.000224514429
0.00132232742,0.640159442,1.99334875e-05,0.000194711843
0.000802594212,0.640347666,1.7502e-05,0.000166558009
0.000478079047,0.640426908,1.0809614e-05,0.000176836208
0.000283663959,0.640501994,8.32740182e-06,0.000150221499
0.000165430845,0.640516674,4.8157637e-06,0.000150512323
9.59887996e-05,0.64051486,2.74758854e-06,0.000143945242
5.45245071e-05,0.640514246,1.08999671e-06,0.000144626957
3.02426394e-05,0.64050316,7.6593042e-07,0.000145713833
EOD
plot $series0 using 1:2:3:4 with xyerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     $series0 using 1:2 with points lc rgb '#000000' pt 6 ps 0.6 title '{/:Italic ϕ}_{u}, uncorrected', \
     $series1 using 1:2:3:4 with xyerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     $series1 using 1:2 with points lc rgb '#000000' pt 7 ps 0.6 title '{/:Italic ϕ}'
set output
