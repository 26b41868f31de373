#!/bin/sh
# Times a figure over 2000 checkpoints, first and again, and compares the bytes:
#   sh tests/bench/figures.sh [GRAINS]
# Needs build/release/shearcell; simulates for some minutes first, in a temporary folder.
set -eu
cd "$(dirname "$0")/../.."

program=$PWD/build/release/shearcell
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat > "$folder/many.yaml" <<MANIFEST
experiment: many
question: How long does a figure over 2000 checkpoints take?
figures: [S2]
base:
  grains: ${1:-1000}
  period_s: 1
  steps_per_cycle: 10000
  settle_time_step_s: 1.0e-4
  cycles: 99
sweep: {grid: {fluid: [still, cell]}}
seeds: 10
MANIFEST
"$program" run "$folder/many.yaml" --store "$folder/store" -q

seconds() {
  start=$(date +%s.%N)
  "$@" > "$folder/said"
  end=$(date +%s.%N)
  head -n 1 "$folder/said"
  echo "$start $end" | awk '{printf "  %.2f s\n", $2 - $1}'
}
seconds "$program" figures S2 --store "$folder/store" --out "$folder/first"
seconds "$program" figures S2 --store "$folder/store" --out "$folder/again"
rm "$folder/store/derived.sqlite"
seconds "$program" figures S2 --store "$folder/store" --out "$folder/fresh"
diff -r "$folder/first" "$folder/again"
diff -r "$folder/first" "$folder/fresh"
seconds "$program" show "$folder/first/many/base/S2a.csv" --store "$folder/store"
du -k "$folder/store/derived.sqlite" | awk '{printf "all the same bytes; derived.sqlite has %d kB\n", $1}'
