#!/bin/sh
# Our engine beside LAMMPS (gran/hooke, Debian's package) on one settled packing, one core each:
#   sh tests/bench/peers.sh [N] [rounds]
# First whether the trajectories agree, then the speed, in turn, with the ratio of the medians.
set -eu
cd "$(dirname "$0")/../.."
grains=${1:-5200}
rounds=${2:-5}

if ! command -v lmp >/dev/null 2>&1; then
  if [ "$(id -u)" -eq 0 ]; then sudo=""; else sudo="sudo"; fi
  $sudo apt-get update -q >&2
  $sudo apt-get install -q -y --no-install-recommends lammps >&2
fi
cmake --preset release -DSHEARCELL_TESTS=ON >/dev/null
cmake --build --preset release --target bench_peers >&2
bench=$PWD/build/release/tests/bench/bench_peers
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export OMP_NUM_THREADS=1

"$bench" prepare "$folder" "$grains"
cd "$folder"
for deck in free drag drag4; do lmp -in $deck.in -log $deck.log >/dev/null; done
"$bench" compare "$folder" "$grains"

: >ours; : >theirs
for round in $(seq "$rounds"); do
  "$bench" ours "$folder" "$grains" >>ours
  lmp -in speed.in -log speed.log >/dev/null
  # "Loop time of T on 1 procs for S steps with A atoms": of the grains alone, without the wall grains.
  awk -v n="$grains" '/^Loop time/ && $9 > 1 {printf "%.4f\n", n * $9 / $4 * 1e-6}' speed.log >>theirs
done
median() { sort -g "$1" | awk '{v[NR] = $1} END {print v[int((NR + 1) / 2)]}'; }
ours=$(median ours)
theirs=$(median theirs)
echo "N = $grains, million particle-steps/s of one core, $rounds rounds in turn:"
echo "  shearcell  median $ours   ($(sort -g ours | head -n 1) to $(sort -g ours | tail -n 1))"
echo "  LAMMPS     median $theirs   ($(sort -g theirs | head -n 1) to $(sort -g theirs | tail -n 1))"
awk -v a="$ours" -v b="$theirs" 'BEGIN {printf "  ratio of medians  %.1f\n", a / b}'
