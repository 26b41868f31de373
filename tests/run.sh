#!/bin/sh
# Installs what is missing, builds and runs every test. Arguments go to ctest, as in
#   sh tests/run.sh -R core
# Tests are compiled several at once, which is least work in all. Who changes one of them often takes
#   cmake --preset debug && cmake --build --preset debug && ctest --preset debug -R core
set -eu
cd "$(dirname "$0")/.."

sh .ci/setup tests
cmake --preset release -DSHEARCELL_TESTS=ON -DSHEARCELL_UNITY_TESTS=ON
cmake --build --preset release
ctest --preset release -j "$(nproc)" "$@"
