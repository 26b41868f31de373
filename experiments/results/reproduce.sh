#!/bin/sh
# Computes the figures of a published folder from scratch and compares their numbers with the published ones, byte for
# byte:
#   sh experiments/results/reproduce.sh FOLDER
# published.txt lists the folders; for the time that one takes see `shearcell plan`. SHEARCELL names a program that is
# built already. Code 1: a number differs.
#   sh experiments/results/reproduce.sh --rows [FOLDER]
# draws the folder, or all, from the published rows (rows.sh) instead: seconds, and the same comparison.
#   sh experiments/results/reproduce.sh --write FOLDER
# writes figures and the table of runs into FOLDER, from the store of $SHEARCELL_STORE, which keeps the runs. A part of
# the campaign is published, once published.txt has its line, by
#   shearcell run experiments/drag.yaml --scale paper --keep-every 20    # with all manifests that share its runs
#   sh experiments/results/rows.sh pack drag
#   sh experiments/results/reproduce.sh --write S2
set -eu
mode=""
case "${1:-}" in --*) mode=$1 && shift ;; esac
here=$(cd "$(dirname "$0")" && pwd)
column() { echo "$line" | cut -d '|' -f "$1" | xargs; }

cd "$here/../.."
if [ -z "${SHEARCELL:-}" ]; then
  sh .ci/setup
  cmake --preset release -DSHEARCELL_TESTS=OFF
  cmake --build --preset release --target shearcell
  SHEARCELL=build/release/shearcell
fi
export SHEARCELL
new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT
[ "$mode" = --write ] || export SHEARCELL_STORE="$new/store"
[ "$mode" != --rows ] || sh "$here/rows.sh" unpack "$new/store"

# Of `cost`, whose runs are partly LAMMPS's, no rows are published.
for folder in ${1:-$(sed -n '/^#/d; /^cost/d; s/ |.*//p' "$here/published.txt")}; do
  line=$(grep "^$folder |" "$here/published.txt") || { echo "published.txt has no folder $folder" >&2; exit 2; }
  # The folder of a figure of all experiments is named by the scale alone. Its manifests are all but accuracy.yaml,
  # which needs LAMMPS and has no part in it.
  case $(column 2) in
    *\**) name="" ;;
    *) name=$(sed -n 's/^experiment: //p' "experiments/$(column 2)") ;;
  esac
  # shellcheck disable=SC2046  # one word an option
  [ "$mode" = --rows ] || "$SHEARCELL" run experiments/$(column 2) $(column 3) $(column 4)
  # shellcheck disable=SC2046
  "$SHEARCELL" figures $(column 5) ${name:+--experiment "$name"} $(column 3) --out "$new/figures"
  made=$(echo "$new/figures/$name"/*)  # of one scale
  if [ "$mode" = --write ]; then
    rm -f "$made"/*.pdf
    mkdir -p "$here/$folder"
    find "$here/$folder" -maxdepth 1 -type f -delete  # also what a figure has no more
    cp "$made"/* "$here/$folder"
    # shellcheck disable=SC2046
    [ -z "$name" ] || "$SHEARCELL" table --per run --experiment "$name" $(column 3) --out "$here/$folder/runs.csv"
    continue
  fi
  for file in "$here/$folder"/*.csv; do
    [ "${file##*/}" != runs.csv ] || continue
    cmp "$file" "$made/${file##*/}"
    echo "$folder/${file##*/}: the published bytes"
  done
  rm -rf "$new/figures"
done
