#!/bin/sh
# Compares our engine with LAMMPS (gran/hooke) and LIGGGHTS (hooke/stiffness), Debian's packages, on one
# packing and one core each:
#   sh tests/bench/peers.sh [N] [rounds]
# First the trajectories, then the speed, in turn, with the ratios of the medians.
set -eu
cd "$(dirname "$0")/../.."
grains=${1:-5200}
rounds=${2:-5}

missing=""
command -v lmp >/dev/null 2>&1 || missing="$missing lammps"
command -v liggghts >/dev/null 2>&1 || missing="$missing liggghts"
if [ -n "$missing" ]; then
  if [ "$(id -u)" -eq 0 ]; then sudo=""; else sudo="sudo"; fi
  $sudo apt-get update -q >&2
  # shellcheck disable=SC2086  # one word per package
  $sudo apt-get install -q -y --no-install-recommends $missing >&2
fi
cmake --preset release -DSHEARCELL_TESTS=ON >/dev/null
cmake --build --preset release --target bench_peers >&2
bench=$PWD/build/release/tests/bench/bench_peers
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export OMP_NUM_THREADS=1

"$bench" prepare "$folder" "$grains"
cd "$folder"
lmp -in free.in >/dev/null
liggghts -in liggghts-free.in >/dev/null 2>&1
"$bench" compare "$folder" "$grains"

# "Loop time of T on 1 procs for S steps with A atoms": of the grains alone, without wall grains.
rate() { awk -v n="$grains" '/^Loop time/ && $9 > 1 {printf "%.4f\n", n * $9 / $4 * 1e-6}' "$1"; }
for round in $(seq "$rounds"); do
  "$bench" ours "$folder" "$grains" >>shearcell.rates
  lmp -in speed.in >lmp.out
  rate lmp.out >>LAMMPS.rates
  liggghts -in liggghts-speed.in >liggghts.out 2>&1
  rate liggghts.out >>LIGGGHTS.rates
done
median() { sort -g "$1" | awk '{v[NR] = $1} END {print v[int((NR + 1) / 2)]}'; }
ours=$(median shearcell.rates)
echo "N = $grains, million particle-steps/s of one core, $rounds rounds in turn:"
for program in shearcell LAMMPS LIGGGHTS; do
  sort -g $program.rates | awk -v name=$program -v ours="$ours" '{v[NR] = $1}
    END {m = v[int((NR + 1) / 2)]
         printf "  %-10s median %7.2f  (%.2f to %.2f)", name, m, v[1], v[NR]
         if (m != ours) printf "  ours is %.1f times that", ours / m
         print ""}'
done
