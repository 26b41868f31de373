#!/bin/sh
# Computes a published figure from scratch and compares its numbers with the published ones, byte for byte:
#   sh experiments/results/reproduce.sh [FIGURE [SCALE [VARIANT...]]]
# Without arguments S1 at scale desk, half a minute once the program is built; for the time of others see
# `shearcell plan`. Of a scale that is published in part, name the variants (amplitude_rad=0.1).
# SHEARCELL names a program that is built already. Code 1: a number differs.
set -eu
cd "$(dirname "$0")/../.."
figure=${1:-S1}
scale=${2:-desk}
[ $# -le 2 ] && set -- all || shift 2
manifests=""
for lineage in experiments/results/"$scale"/*/"$figure".lineage.json; do
  [ ! -f "$lineage" ] || manifests="$manifests experiments/$(basename "$(dirname "$lineage")").yaml"
done
[ -n "$manifests" ] || { echo "experiments/results/$scale has no figure $figure" >&2; exit 2; }
if [ -z "${SHEARCELL:-}" ]; then
  sh .ci/setup
  cmake --preset release -DSHEARCELL_TESTS=OFF
  cmake --build --preset release --target shearcell
  SHEARCELL=build/release/shearcell
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for variant; do
  # shellcheck disable=SC2046,SC2086  # one word a manifest; no option for all variants
  "$SHEARCELL" run $manifests --scale "$scale" $([ "$variant" = all ] || echo --variant "$variant") \
    --store "$folder/store"
done
"$SHEARCELL" figures "$figure" --scale "$scale" --store "$folder/store" --out "$folder/figures"
cd "$folder/figures"
for file in */*.csv; do
  cmp "$file" "$OLDPWD/experiments/results/$scale/$file"
  echo "$file: the published bytes"
done
