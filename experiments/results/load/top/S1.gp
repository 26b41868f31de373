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
0.00375488624,0.651676534,4.20902203e-05,0.000330182241
0.00254699454,0.648399283,4.1539479e-05,0.00031723161
0.00159852712,0.645630376,1.35339482e-05,0.00028928237
0.000991031385,0.643744955,1.65771809e-05,0.000281841615
0.000553443557,0.642395963,1.10920554e-05,0.000260383017
0.000329244164,0.641768023,6.73217482e-06,0.00024323959
0.000197524809,0.641324099,4.2527258e-06,0.000240832197
0.000114616768,0.641043342,2.05954183e-06,0.000247772574
6.4273323e-05,0.640897371,1.0754472e-06,0.000250997376
EOD
$series1 << EOD
0.00375488624,0.638795239,4.20902203e-05,0.000254748958
0.00254699454,0.639680435,4.1539479e-05,0.000275727244
0.00159852712,0.640199777,1.35339482e-05,0.000268009169
0.000991031385,0.640401193,1.65771809e-05,0.000248117594
0.000553443557,0.640545196,1.10920554e-05,0.00024087067
0.000329244164,0.640674197,6.73217482e-06,0.000236987737
0.000197524809,0.640669072,4.2527258e-06,0.000237237832
0.000114616768,0.640664396,2.05954183e-06,0.000245102037
6.4273323e-05,0.640685365,1.0754472e-06,0.000250341994
EOD
plot $series0 using 1:2:3:4 with xyerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     $series0 using 1:2 with points lc rgb '#000000' pt 6 ps 0.6 title '{/:Italic ϕ}_{u}, uncorrected', \
     $series1 using 1:2:3:4 with xyerrorbars lc rgb '#000000' lw 0.8 pt 0 notitle, \
     $series1 using 1:2 with points lc rgb '#000000' pt 7 ps 0.6 title '{/:Italic ϕ}'
set output
