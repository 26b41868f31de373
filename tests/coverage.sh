#!/bin/sh
# Which lines and branches the tests reach, folder by folder: sh tests/coverage.sh [ctest arguments]
# Builds with clang (preset coverage; Debian: clang, llvm) and runs the tests, except the installation, the
# documents' commands, Slurm and Chromium. Prints the table; build/coverage/coverage.json has each file.
# Takes half an hour on two cores.
set -eu
cd "$(dirname "$0")/.."
for tool in clang++ llvm-profdata llvm-cov; do
  command -v "$tool" > /dev/null || { echo "coverage: $tool is not installed (Debian: clang llvm)"; exit 1; }
done
build="$PWD/build/coverage"
LLVM_PROFILE_FILE=/dev/null  # while the build lists its tests
export LLVM_PROFILE_FILE
[ -f "$build/build.ninja" ] || cmake --preset coverage > /dev/null
cmake --build "$build" >&2

# Processes of one program share a file; a killed process writes nothing.
rm -rf "$build/profiles"
LLVM_PROFILE_FILE="$build/profiles/%2m.profraw"
export LLVM_PROFILE_FILE
ctest --test-dir "$build" -j "$(nproc)" -E '^(install|docs)|report\.(Campaign|Browser|Quick)|cluster.Slurm$' --timeout 1800 "$@" > "$build/tests.log" ||
  echo "some tests failed, see build/coverage/tests.log"
tail -n 3 "$build/tests.log" >&2

unset LLVM_PROFILE_FILE
llvm-profdata merge -sparse "$build"/profiles/*.profraw -o "$build/coverage.profdata"
objects=""
for program in "$build"/tests/*/test_*; do
  [ ! -x "$program" ] || [ -d "$program" ] || objects="$objects -object $program"
done
# shellcheck disable=SC2086  # one word per object
llvm-cov export -summary-only -instr-profile "$build/coverage.profdata" "$build/shearcell" $objects \
  > "$build/coverage.json"
python3 tests/coverage.py "$build/coverage.json" "$PWD"
