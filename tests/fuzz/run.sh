#!/bin/sh
# Fuzzes every target for so many seconds each: sh tests/fuzz/run.sh [SECONDS] [TARGET...]
# Builds with clang and libFuzzer (Debian: clang, libclang-rt-dev, llvm for coverage). Prints one
# line a target; with a fault it ends with 1 and the input is in build/fuzz/faults/TARGET.
# The corpora grow in build/fuzz/corpus; an input that found a fault belongs into
# tests/fuzz/regressions/TARGET, where the ordinary suite runs it for ever.
set -eu
cd "$(dirname "$0")/../.."
seconds="${1:-10}"
[ $# -eq 0 ] || shift
targets="${*:-checkpoint events manifest measures packing published store}"

if ! command -v clang++ >/dev/null 2>&1; then
  echo "fuzzing: left out, clang is not installed (Debian: clang libclang-rt-dev)"
  exit 0
fi
build="$PWD/build/fuzz"
[ -f "$build/build.ninja" ] || cmake --preset fuzz >/dev/null
cmake --build "$build" --target fuzz >&2

# The keys of all parameters, from the reference that the program printed.
dictionary="$build/manifest.dict"
{ cat tests/fuzz/manifest.dict
  sed -n '/^## Parameters/,/^## Measures/s/^| `\([a-zA-Z_0-9]*\)` | .*/"\1: "/p' experiments/REFERENCE.md; } >"$dictionary"

. tests/in_memory.sh
export ASAN_OPTIONS="detect_leaks=1:allocator_may_return_null=0:max_allocation_size_mb=1024"
export UBSAN_OPTIONS="print_stacktrace=1"

program="$build/tests/fuzz/fuzz"
total=0
failed=0
for target in $targets; do
  corpus="$build/corpus/$target"
  faults="$build/faults/$target"
  log="$build/fuzz-$target.log"
  mkdir -p "$corpus" "$faults"
  "$program" "--target=$target" "--write-seeds=$TMPDIR/seeds-$target"
  regressions="tests/fuzz/regressions/$target"
  [ -d "$regressions" ] || regressions=""
  words=""
  longest=4096
  case $target in
    manifest) words="-dict=$dictionary" ;;
    checkpoint) longest=65536 ;;
  esac
  code=0
  # shellcheck disable=SC2086
  "$program" "--target=$target" -max_total_time="$seconds" -timeout=25 -rss_limit_mb=2048 -max_len="$longest" \
    -print_final_stats=1 $words -artifact_prefix="$faults/" "$corpus" "$TMPDIR/seeds-$target" \
    $regressions >"$log" 2>&1 || code=$?
  runs="$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")"
  coverage="$(sed -n 's/.* cov: \([0-9]*\) ft: \([0-9]*\) corp: \([0-9]*\).*/\1 edges, \2 features, corpus \3/p' "$log" | tail -n 1)"
  echo "$target: ${runs:-0} executions, ${coverage:-no coverage}$([ "$code" -eq 0 ] || echo "; FAULT, see $log and $faults")"
  total=$((total + ${runs:-0}))
  [ "$code" -eq 0 ] || failed=1
done
echo "all: $total executions"
exit $failed
