#!/bin/sh
# The engine's golden states from other builds than the release one: g++ without optimization, clang++, and NEON on 64-bit
# ARM, which qemu emulates.
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

# A project of its own, since the libraries of this machine are not for ARM. Eigen and Highway need only their headers.
folder=build/bits-aarch64
mkdir -p "$folder/include"
ln -sfn /usr/include/hwy "$folder/include/hwy"
ln -sfn /usr/include/eigen3/Eigen "$folder/include/Eigen"
cmake -S tests/core/aarch64 -B "$folder" -G Ninja >/dev/null
cmake --build "$folder" >/dev/null
qemu-aarch64-static "$folder/test_bits" --gtest_brief=1 --gtest_filter='Reproducible.TheBits*:Reproducible.Deep*'
echo "aarch64: the same bits"
