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
. tests/in_memory.sh
# One more than there are cores, since some tests wait for a clock or for other programs.
ctest --preset release -j "$(($(nproc) + 1))" "$@"
