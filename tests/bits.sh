#!/bin/sh
# The engine's golden states from other builds than the release one: g++ without optimization, clang++, and NEON on 64-bit
# ARM, which qemu emulates. Each builds the engine alone.
#   sh tests/bits.sh
set -eu
cd "$(dirname "$0")/.."

sh .ci/setup tests
build() {  # name, compiler, build type, more options: the program that compares the states
  folder=build/bits-$1
  mkdir -p "$folder/include"
  ln -sfn /usr/include/hwy "$folder/include/hwy"
  ln -sfn /usr/include/eigen3/Eigen "$folder/include/Eigen"
  compiler=$2 type=$3
  shift 3
  cmake -S tests/core/bits -B "$folder" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE="$type" "$@" >/dev/null
  cmake --build "$folder" >"$folder/build.log" || {
    cat "$folder/build.log" >&2
    return 1
  }
}
build g++ g++ Debug
build clang++ clang++ Release
build aarch64 aarch64-linux-gnu-g++ Release -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64
build/bits-g++/test_bits &
plain=$!
build/bits-clang++/test_bits
echo "clang++: the same bits"
qemu-aarch64-static build/bits-aarch64/test_bits sheared deep
echo "aarch64: the same bits"
wait "$plain"
echo "g++ without optimization: the same bits"
