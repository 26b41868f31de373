#!/bin/sh
# From a fresh clone to a figure: installs what is missing, builds, runs drag.yaml at scale smoke and
# regenerates its figures. A second call only does what is not done yet.
set -eu
cd "$(dirname "$0")/.."

sh .ci/setup
cmake --preset release -DSHEARCELL_TESTS=OFF
cmake --build --preset release --target shearcell

program=build/release/shearcell
store=${SHEARCELL_STORE:-shearcell-store}
out=shearcell-figures
$program run experiments/drag.yaml --scale smoke --store "$store"
$program figures S2 --scale smoke --store "$store" --out "$out"
echo
echo "The figures are in $PWD/$out/drag/smoke, the checkpoints they came from in $store."
echo "Next: $program --help, or the table of experiments in experiments/README.md."
