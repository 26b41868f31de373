#!/bin/sh
# Computes the figures of a published folder from scratch and compares their numbers with the published ones, byte for
# byte:
#   sh experiments/results/reproduce.sh [FOLDER]
# published.txt lists the folders. Without FOLDER desk/spring_constant, half a minute once the program is built; for the
# time of others see `shearcell plan`. SHEARCELL names a program that is built already. Code 1: a number differs.
#   sh experiments/results/reproduce.sh --write FOLDER
# writes figures and the table of runs into FOLDER instead, and keeps the runs in the store of $SHEARCELL_STORE.
set -eu
write=""
[ "${1:-}" != --write ] || { write=yes && shift; }
here=$(cd "$(dirname "$0")" && pwd)
folder=${1:-desk/spring_constant}
line=$(grep "^$folder |" "$here/published.txt") || { echo "published.txt has no folder $folder" >&2; exit 2; }
column() { echo "$line" | cut -d '|' -f "$1" | xargs; }

cd "$here/../.."
if [ -z "${SHEARCELL:-}" ]; then
  sh .ci/setup
  cmake --preset release -DSHEARCELL_TESTS=OFF
  cmake --build --preset release --target shearcell
  SHEARCELL=build/release/shearcell
fi
new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT
[ -n "$write" ] || export SHEARCELL_STORE="$new/store"
name=$(basename "$folder")
# shellcheck disable=SC2046  # one word an option
{
  "$SHEARCELL" run experiments/$(column 2) $(column 3) $(column 4)
  "$SHEARCELL" figures $(column 5) --experiment "$name" $(column 3) --out "$new/figures"
}
made=$(echo "$new/figures/$name"/*)  # of one scale
if [ -n "$write" ]; then
  rm -f "$made"/*.pdf
  mkdir -p "$here/$folder"
  find "$here/$folder" -maxdepth 1 -type f -delete  # also what a figure has no more
  cp "$made"/* "$here/$folder"
  # shellcheck disable=SC2046
  "$SHEARCELL" table --per run --experiment "$name" $(column 3) --out "$here/$folder/runs.csv"
  exit
fi
for file in "$here/$folder"/*.csv; do
  [ "${file##*/}" != runs.csv ] || continue
  cmp "$file" "$made/${file##*/}"
  echo "$folder/${file##*/}: the published bytes"
done
