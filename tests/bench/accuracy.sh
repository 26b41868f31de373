#!/bin/sh
# Measures again what core/ACCURACY.md says, and writes its table and figures (LAMMPS and gnuplot must be installed):
#   sh tests/bench/accuracy.sh
set -eu
cd "$(dirname "$0")/../.."
cmake --preset release -DSHEARCELL_TESTS=ON >/dev/null
cmake --build --preset release --target bench_accuracy >&2
build/release/tests/bench/bench_accuracy experiments/results/accuracy
python3 -B tests/bench/accuracy.py experiments/results/accuracy | python3 -B tests/docs/insert_tables.py core/ACCURACY.md
