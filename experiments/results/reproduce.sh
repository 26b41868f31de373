#!/bin/sh
# Computes a published figure from scratch and compares its numbers with those in desk/, byte for byte:
#   sh experiments/results/reproduce.sh [FIGURE]
# Without a name S1, half a minute once the program is built; others take up to an hour
# (`shearcell plan`). SHEARCELL names a program that is built already. Code 1: a number differs.
set -eu
cd "$(dirname "$0")/../.."
figure=${1:-S1}
manifests=$(grep -lE "^figures: .*[[ ,]$figure[],]" experiments/*.yaml) || {
  echo "no manifest makes a figure $figure" >&2
  exit 2
}
if [ -z "${SHEARCELL:-}" ]; then
  sh .ci/setup
  cmake --preset release -DSHEARCELL_TESTS=OFF
  cmake --build --preset release --target shearcell
  SHEARCELL=build/release/shearcell
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck disable=SC2086  # one word a manifest
"$SHEARCELL" run $manifests --scale desk --store "$folder/store"
"$SHEARCELL" figures "$figure" --scale desk --store "$folder/store" --out "$folder/figures"
cd "$folder/figures"
for file in */*.csv; do
  cmp "$file" "$OLDPWD/experiments/results/desk/$file"
  echo "$file: the published bytes"
done
