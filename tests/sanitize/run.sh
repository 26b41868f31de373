#!/bin/sh
# Sanitizers, a second compiler and static analysis. Prints one line per part:
#   sh tests/sanitize/run.sh                  # every part; without anything cached, an hour or two on two cores
#   sh tests/sanitize/run.sh tidy cppcheck    # some parts
#   SUITES="provenance manifest" sh tests/sanitize/run.sh asan     # some test programs alone
# Installs nothing. Ends with 1 at the first finding and shows it, with 2 if a program is missing.
# The output of a part is in build/sanitize/PART.log. JOBS: number of jobs at once (default: all cores).
# The sanitizers' options are in CMakePresets.json; suppressions are in the files beside this one.
set -eu
cd "$(dirname "$0")/../.."
jobs="${JOBS:-$(nproc)}"
logs="$PWD/build/sanitize"
beside="tests/sanitize"
mkdir -p "$logs"

# Tests that are left out here. (tests/*/CMakeLists.txt leave Slurm, the installation and the documentation's
# commands out of every sanitized build.)
#   report.Campaign   every manifest at scale smoke: too slow; each protocol and figure has smaller tests
#   report.Browser, report.Quick    Chromium opens that report; other tests make and read reports
#   docs.rows         draws every published figure: too slow; each figure has smaller tests
#   bench.Speed.NoKernelIsFasterThanTheMachine    compares rates, which the sanitizers change
left_out='^(report\.(Campaign|Browser|Quick)|docs\.rows|bench\.Speed\.NoKernelIsFasterThanTheMachine)$'

need() {  # need PROGRAM PACKAGE
  command -v "$1" >/dev/null && return
  echo "$part: cannot run, $1 is missing (Debian: apt-get install $2)"
  exit 2
}

finding() {  # finding PATTERN: what the log says from its first lines of that kind on
  echo "$part: FOUND (all of it in $logs/$part.log)"
  grep -E -A 15 -m 2 "$1" "$logs/$part.log" | head -n 50
  exit 1
}

build() {  # build PRESET: all of it, or the test programs of SUITES
  cmake --preset "$1" -DSHEARCELL_WERROR=ON >"$logs/$part.log" 2>&1 || finding 'CMake Error'
  targets="all"
  [ -z "$suites" ] || targets="$(echo "$suites" | sed 's/[^ ]*/test_&/g')"
  # shellcheck disable=SC2086  # one word per target
  cmake --build --preset "$1" -j "$jobs" --target $targets >>"$logs/$part.log" 2>&1 ||
    finding 'error:|FAILED:'
}

run_tests() {  # run_tests PRESET
  chosen="$(echo "$suites" | tr ' ' '|')"
  ctest --preset "$1" -j "$jobs" --no-tests=error -R "^(${chosen:-.*})\." -E "$left_out" \
    >>"$logs/$part.log" 2>&1 ||
    finding 'ERROR: |runtime error|WARNING: ThreadSanitizer|: Failure|\*\*\*(Failed|Timeout|Exception)'
  said="$(sed -n 's/.* tests failed out of \([0-9]*\)/\1 tests/p' "$logs/$part.log")"
}

run_asan() {
  build asan
  run_tests asan
}

run_tsan() {
  build tsan
  run_tests tsan
}

run_clang() {
  need clang++ clang
  build clang
  said="no warning"
}

run_tidy() {
  need clang++ clang
  need run-clang-tidy clang-tidy
  cmake --preset clang >"$logs/$part.log" 2>&1 || finding 'CMake Error'
  run-clang-tidy -quiet -p build/clang -j "$jobs" '\.c(pp|xx)$' >>"$logs/$part.log" 2>&1 ||
    finding '(error|warning): '
  said="nothing found"
}

run_cppcheck() {
  need cppcheck cppcheck
  cppcheck --quiet --std=c++20 --language=c++ --library=googletest -I . -j "$jobs" --error-exitcode=1 \
    --enable=warning,performance,portability --suppressions-list="$beside/cppcheck.supp" \
    core protocols provenance analysis experiments tests >"$logs/$part.log" 2>&1 || finding '.'
  said="nothing found"
}

# valgrind has no AVX-512, so the program uses its AVX2 kernel. It cannot read the DWARF 5 of clang 14, so the
# preset asks for DWARF 4. Properties get a tenth of their inputs.
run_valgrind() {
  need valgrind valgrind
  need clang++ clang
  suites="${suites:-provenance manifest}"
  build clang
  for suite in $suites; do
    program="$(find build/clang/tests -name "test_$suite" -type f)"
    RC_PARAMS="seed=2020 max_success=10" valgrind --quiet --error-exitcode=9 --leak-check=full --show-leak-kinds=definite \
      --errors-for-leak-kinds=definite --trace-children=no \
      "$program" --gtest_brief=1 >>"$logs/$part.log" 2>&1 || finding '^==[0-9]+== |Failure'
  done
  said="$suites"
}

[ $# -gt 0 ] || set -- cppcheck tidy clang asan tsan valgrind
for part in "$@"; do
  case $part in
    asan | tsan | clang | tidy | cppcheck | valgrind) ;;
    *) echo "there is no part $part; there are asan tsan clang tidy cppcheck valgrind" >&2; exit 2 ;;
  esac
  began="$(date +%s)"
  suites="${SUITES:-}"
  need cmake cmake
  "run_$part"
  took=$(($(date +%s) - began))
  echo "$part: clean, $said, $((took / 60)) min $((took % 60)) s"
done
