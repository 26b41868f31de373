#!/bin/sh
# The engine's golden state from builds other than the release one: g++ without optimization, and
# clang++ (installed when missing).
#   sh tests/bits.sh
set -eu
cd "$(dirname "$0")/.."

sh .ci/setup tests
if ! command -v clang++ >/dev/null 2>&1; then
  if [ "$(id -u)" -eq 0 ]; then sudo=""; else sudo="sudo"; fi
  $sudo apt-get update -q >&2
  $sudo apt-get install -q -y --no-install-recommends clang >&2
fi
check() {  # compiler, build type, tests
  folder=build/bits-$1-$2
  cmake -S . -B "$folder" -G Ninja -DCMAKE_CXX_COMPILER="$1" -DCMAKE_BUILD_TYPE="$2" >/dev/null
  cmake --build "$folder" --target test_core >/dev/null
  "$folder/tests/core/test_core" --gtest_brief=1 --gtest_filter="$3"
  echo "$1 $2: the same bits"
}
check g++ Debug 'Reproducible.TheBits*:Minimizer.GivesTheSameBits*'
check clang++ Release 'Reproducible.*:Minimizer.GivesTheSameBits*'
