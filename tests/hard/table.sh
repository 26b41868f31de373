#!/bin/sh
# Runs every hard case with all of its steps and writes the outcomes into outcomes.csv and core/STABILITY.md:
#   sh tests/hard/table.sh                  # configures and builds the preset release first
#   sh tests/hard/table.sh check BUILD      # changes nothing; fails if the outcomes are others
set -eu
cd "$(dirname "$0")/../.."
build=${2:-build/release}
if [ "${1:-}" != check ]; then
  cmake --preset release -DSHEARCELL_TESTS=ON >/dev/null
  cmake --build --preset release --target test_hard >&2
fi
results=$(mktemp)
trap 'rm -f "$results"' EXIT
code=0
SHEARCELL_HARD=full ctest --test-dir "$build" -L '^hard$' -j "$(nproc)" --test-output-size-passed 65536 \
  --output-junit "$results" >&2 || code=$?
python3 -B tests/hard/table.py "$results" tests/hard/outcomes.csv ${1:+"$1"} | python3 -B tests/docs/insert_tables.py core/STABILITY.md ${1:+"$1"}
exit "$code"
