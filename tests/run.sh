#!/bin/sh
# Installs what is missing, builds and runs every test. Arguments go to ctest, as in
#   sh tests/run.sh -R core
set -eu
cd "$(dirname "$0")/.."

sh .ci/setup tests
cmake --preset release -DSHEARCELL_TESTS=ON
cmake --build --preset release
ctest --preset release -j "$(nproc)" "$@"
