#!/bin/sh
# From a fresh clone to a figure with a verdict: installs what is missing, builds, shears grains between rough and between
# smooth walls (walls.yaml at scale smoke), draws its figure and makes the report. A second call only does what is not
# done yet.
set -eu
cd "$(dirname "$0")/.."

sh .ci/setup report
cmake --preset release -DSHEARCELL_TESTS=OFF
cmake --build --preset release --target shearcell

program=build/release/shearcell
store=${SHEARCELL_STORE:-shearcell-store}
out=shearcell-figures
$program run experiments/walls.yaml --scale smoke --store "$store"
$program figures walls --scale smoke --store "$store" --out "$out"
$program report --experiment walls --scale smoke --store "$store" --out "$out/report.html"
echo
echo "Between smooth walls the grains crystallize within ten cycles of shear; rough walls delay this by more than a factor"
echo "of two. See $PWD/$out/walls/smoke/walls_b.svg,"
echo "and turn the packings in 3D in $PWD/$out/report.html. Their checkpoints are in $store."
echo "Next: $program --help, or the table of experiments in experiments/README.md."
