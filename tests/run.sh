#!/bin/sh
# Installs missing packages, builds, and runs every test. Arguments go to ctest:
#   sh tests/run.sh -R core
# To work on one test file, build one file at a time instead:
#   cmake --preset debug && cmake --build --preset debug && ctest --preset debug -R core
set -eu
cd "$(dirname "$0")/.."

sh .ci/setup tests
cmake --preset release -DSHEARCELL_TESTS=ON -DSHEARCELL_UNITY_TESTS=ON
cmake --build --preset release
# Temporary stores in memory if there is room (the tests use 0.2 GB): on a slow disk, tests of the store wait for it ten
# times as long as they compute.
room=$(df -k --output=avail /dev/shm 2>/dev/null | tail -n 1)
if [ -z "${TMPDIR:-}" ] && [ -w /dev/shm ] && [ "${room:-0}" -gt 2000000 ]; then
  TMPDIR=$(mktemp -d /dev/shm/shearcell-tests-XXXXXX)
  chmod 755 "$TMPDIR"  # Slurm's daemons have other users
  export TMPDIR
  trap 'rm -rf "$TMPDIR"' EXIT
fi
# One more than there are cores, since some tests wait for a clock or for other programs.
ctest --preset release -j "$(($(nproc) + 1))" "$@"
