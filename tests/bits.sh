#!/bin/sh
# The engine's golden states from other builds than the release one: g++ without optimization, and clang++.
#   sh tests/bits.sh
set -eu
cd "$(dirname "$0")/.."

sh .ci/setup tests
check() {  # compiler, build type, tests
  folder=build/bits-$1-$2
  cmake -S . -B "$folder" -G Ninja -DCMAKE_CXX_COMPILER="$1" -DCMAKE_BUILD_TYPE="$2" >/dev/null
  cmake --build "$folder" --target test_bits >/dev/null
  "$folder/tests/core/test_bits" --gtest_brief=1 --gtest_filter="$3"
  echo "$1 $2: the same bits"
}
check g++ Debug 'Reproducible.TheBits*:Minimizer.GivesTheSameBits*'
check clang++ Release 'Reproducible.*:Minimizer.GivesTheSameBits*'
