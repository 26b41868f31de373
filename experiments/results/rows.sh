#!/bin/sh
# The numbers behind the published figures, as stores without checkpoint files: rows/NAME.tar.xz. Stores of several
# parts of a campaign, from several machines, are merged where figures are drawn.
#   sh experiments/results/rows.sh pack NAME     # the store of $SHEARCELL_STORE, without its files, as rows/NAME.tar.xz
#   sh experiments/results/rows.sh pack NAME crystallites    # without these measures, which C, S7 and committor alone need
#   sh experiments/results/rows.sh unpack STORE  # all rows, merged into the new store STORE
# SHEARCELL names the program; default: build/release/shearcell. `pack` works on a copy of the store.
set -eu
rows=$(cd "$(dirname "$0")" && pwd)/rows
program=${SHEARCELL:-$rows/../../../build/release/shearcell}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
case "${1:-} ${2:-}" in
  "pack "?*)
    "$program" merge "${SHEARCELL_STORE:-shearcell-store}" --store "$work/store"
    "$program" prune --last-too --yes --store "$work/store"
    if [ -n "$(find "$work/store/objects" -type f)" ]; then
      echo "runs are unfinished, so their files are needed: finish them with \`shearcell resume\`" >&2
      exit 1
    fi
    # Without what the published figures do not draw: curves, stresses, motion.
    name=$2
    shift 2
    python3 - "$work/store/derived.sqlite" "$@" << 'END'
import sqlite3
import sys
kept = sqlite3.connect(sys.argv[1], isolation_level=None)
for name in ("lattices", "mechanics", "motion", "motion_10", "motion_100", "pair_correlation", "profiles", "sensitivity",
             "structure_factor", "wall_distance", *sys.argv[2:]):
    kept.execute("DELETE FROM derived WHERE measure LIKE ? || ' %'", (name,))
kept.execute("VACUUM")
END
    mkdir -p "$rows"
    tar -C "$work/store" --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -c store.sqlite derived.sqlite |
      xz -9e > "$rows/$name.tar.xz"
    ls -l "$rows/$name.tar.xz" ;;
  "unpack "?*)
    for part in "$rows"/*.tar.xz; do
      mkdir "$work/$(basename "$part" .tar.xz)"
      tar -C "$work/$(basename "$part" .tar.xz)" -xJf "$part"
    done
    "$program" merge "$work"/* --store "$2" ;;
  *) sed -n '2,8s/^# //p' "$0" >&2; exit 2 ;;
esac
