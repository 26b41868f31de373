#!/bin/sh
# What only instruments find: sanitizers, a second compiler, static analysis. One line a part:
#   sh tests/sanitize/run.sh                      # everything, an hour or two
#   sh tests/sanitize/run.sh tidy cppcheck        # some parts
#   SUITES="provenance manifest" sh tests/sanitize/run.sh asan      # some test programs alone
# Installs nothing. Ends with 1 at the first finding and shows it; with 2 where a tool is missing.
# The whole of what each part said is in build/sanitize/PART.log. JOBS (all cores) limits what runs at once.
set -eu
cd "$(dirname "$0")/../.."
jobs="${JOBS:-$(nproc)}"
suites="${SUITES:-}"
folders="core protocols provenance analysis experiments tests"
logs="$PWD/build/sanitize"
mkdir -p "$logs"

# Tests that a sanitized build has, and that are left out, each with its reason. (What starts Slurm, installs,
# or runs the documentation's commands is no part of a sanitized build: tests/*/CMakeLists.txt.)
#   report.Browser: says how soon Chromium shows the report, a time; the report itself is made by other tests.
left_out='report\.Browser'

need() {  # need PROGRAM PACKAGE
  command -v "$1" >/dev/null 2>&1 && return
  echo "$part: cannot run, $1 is missing (Debian: apt install $2)"
  exit 2
}

finding() {
  echo "$part: FOUND, in $logs/$part.log:"
  grep -E -A 15 -m 3 "${1:-.}" "$logs/$part.log" | head -n 60
  exit 1
}

build() {  # build PRESET: the whole project, or the test programs of SUITES
  cmake --preset "$1" -DSHEARCELL_WERROR=ON >"$logs/$part.log" 2>&1 || finding 'CMake Error'
  targets="all"
  [ -z "$suites" ] || targets="$(printf 'test_%s ' $suites)"
  # shellcheck disable=SC2086  # one word a target
  cmake --build "build/$1" -j "$jobs" --target $targets >>"$logs/$part.log" 2>&1 ||
    finding 'error:|FAILED:'
}

run_tests() {  # run_tests PRESET, in a build of the whole project or of SUITES
  chosen=""
  [ -z "$suites" ] || chosen="-R ^($(echo $suites | tr ' ' '|'))\."
  # shellcheck disable=SC2086  # nothing, or an option and its value
  ctest --test-dir "build/$1" -j "$jobs" --output-on-failure --no-tests=error $chosen -E "$left_out" \
    >>"$logs/$part.log" 2>&1 || finding 'ERROR: |runtime error|WARNING: ThreadSanitizer|Failure|\*\*\*'
  said="$(sed -n 's/.*tests passed, 0 tests failed out of \([0-9]*\)/\1 tests/p' "$logs/$part.log")"
}

asan() {
  need g++ g++
  ASAN_OPTIONS="detect_leaks=1:detect_stack_use_after_return=1:strict_string_checks=1:check_initialization_order=1"
  UBSAN_OPTIONS="print_stacktrace=1"
  LSAN_OPTIONS="suppressions=$PWD/tests/sanitize/lsan.supp:print_suppressions=0"
  export ASAN_OPTIONS UBSAN_OPTIONS LSAN_OPTIONS
  build asan
  run_tests asan
}

tsan() {
  need g++ g++
  TSAN_OPTIONS="suppressions=$PWD/tests/sanitize/tsan.supp:second_deadlock_stack=1"
  export TSAN_OPTIONS
  build tsan
  run_tests tsan
}

clang() {
  need clang++ clang
  build clang
  said="$(grep -c '"file"' build/clang/compile_commands.json) files compiled, no warning"
}

tidy() {
  need clang++ clang
  need run-clang-tidy clang-tidy
  cmake --preset clang >"$logs/$part.log" 2>&1 || finding 'CMake Error'
  run-clang-tidy -quiet -p build/clang -j "$jobs" '\.(cpp|cxx)$' >>"$logs/$part.log" 2>&1 || finding '(error|warning): '
  ! grep -qE '(error|warning): ' "$logs/$part.log" || finding '(error|warning): '
  said="no finding"
}

cppcheck() {
  need cppcheck cppcheck
  # shellcheck disable=SC2086  # one word a folder
  command cppcheck --quiet --std=c++20 --language=c++ --library=googletest -I . -j "$jobs" --error-exitcode=1 \
    --enable=warning,performance,portability --suppressions-list=tests/sanitize/cppcheck.supp $folders \
    >"$logs/$part.log" 2>&1 || finding
  said="no finding"
}

# valgrind knows no AVX-512: it tells programs that the processor has none, and the AVX2 kernel runs.
valgrind() {
  need valgrind valgrind
  need clang++ clang
  suites="${SUITES:-core protocols provenance manifest}"
  build clang
  for suite in $suites; do
    command valgrind --quiet --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite \
      --suppressions=tests/sanitize/valgrind.supp "build/clang/tests/$(folder_of "$suite")/test_$suite" \
      --gtest_brief=1 --gtest_filter="$small" >>"$logs/$part.log" 2>&1 || finding '==[0-9]+== |Failure'
  done
  said="$suites"
}

for part in ${*:-cppcheck clang tidy asan tsan valgrind}; do
  case $part in
    asan | tsan | clang | tidy | cppcheck | valgrind) ;;
    *) echo "there is no part $part; known are asan tsan clang tidy cppcheck valgrind" >&2; exit 2 ;;
  esac
  began="$(date +%s)"
  "$part"
  took=$(($(date +%s) - began))
  echo "$part: clean, $said, $((took / 60)) min $((took % 60)) s"
done
