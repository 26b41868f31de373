#!/bin/sh
# Compares our engine with LAMMPS (gran/hooke) and LIGGGHTS (hooke/stiffness) on one packing and one core each:
#   sh tests/bench/peers.sh [--native] [--simd avx2] [N] [rounds]
# N is the number of grains (5200). Both are Debian's packages. --native also compiles Debian's source of LAMMPS for this
# machine and measures it, without and with LAMMPS's package OPENMP. This takes ten minutes; later calls find the program
# in ~/.cache/shearcell-peers. --simd avx2 runs our engine, and compiles LAMMPS, without AVX-512.
# Every program runs with each neighbour skin. First the trajectories, then the speed, in turn, with the ratio of the
# speeds in each round (5 rounds).
set -eu
cd "$(dirname "$0")/../.."
native=no simd=best
skins="0.02 0.04 0.06 0.1 0.15"  # [d]
flags="-O3 -march=native -ffast-math -fopenmp"
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) sed -n '2,/^set/s/^# //p' tests/bench/peers.sh; exit 0 ;;
    --native) native=yes; shift ;;
    --simd)
      [ "${2:-}" = avx2 ] || { echo "peers.sh: --simd ${2:-}: only avx2 can be chosen" >&2; exit 2; }
      simd=avx2 flags="$flags -mno-avx512f"
      shift 2 ;;
    -*) echo "peers.sh: $1 is not an option; see --help" >&2; exit 2 ;;
    *) break ;;
  esac
done
grains=${1:-5200}
rounds=${2:-5}

sh .ci/setup peers
cmake --preset release >/dev/null
cmake --build --preset release --target bench_peers >&2
bench=$PWD/build/release/tests/bench/bench_peers
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
trap 'exit 130' INT TERM
cd "$folder"
export OMP_NUM_THREADS=1

# Compiles the source of the installed LAMMPS, without MPI and with these two of its packages.
compile_lammps() {
  # The user's apt configuration seldom names sources. This one has those of the archive that offers the package.
  mkdir -p apt/lists/partial apt/archives/partial
  apt-cache policy lammps |
    sed -n 's|^ *[0-9]* \(http[^ ]*\) \([^ ]*\)/\([^ ]*\) .* Packages$|deb-src \1 \2 \3|p' >apt/sources.list
  set -- -q -o "Dir::Etc::SourceList=$PWD/apt/sources.list" -o Dir::Etc::SourceParts=/dev/null \
    -o "Dir::State::Lists=$PWD/apt/lists" -o "Dir::Cache=$PWD/apt"
  apt-get "$@" update &&
    apt-get "$@" source --only-source "lammps=$version" &&
    make -C lammps-*/src yes-GRANULAR yes-OPENMP mpi-stubs &&
    nice make -C lammps-*/src -j2 serial CCFLAGS="$flags -std=c++11" LINKFLAGS="$flags"
}

"$bench" prepare "$folder" "$grains" "$simd"
echo "LAMMPS: Debian's $(dpkg-query -W -f '${Version}' lammps), $(lmp -h | sed -n 's/^Compiler: //p'), -O2"
echo "LIGGGHTS: Debian's $(dpkg-query -W -f '${Version}' liggghts), -O2"
programs="LAMMPS LIGGGHTS"
if [ $native = yes ]; then
  programs="LAMMPS LAMMPS-native LAMMPS-native-omp LIGGGHTS"
  version=$(dpkg-query -W -f '${source:Version}' lammps)
  # shellcheck disable=SC2086  # one word per flag
  target=$(g++ $flags -Q --help=target)
  key=$({ echo "$version $flags $target"; g++ --version; } | sha256sum | cut -c 1-16)
  compiled=${XDG_CACHE_HOME:-$HOME/.cache}/shearcell-peers/lammps-$key
  if [ ! -x "$compiled" ]; then
    echo "compiling LAMMPS $version" >&2
    compile_lammps >compile.log 2>&1 || {
      tail -n 30 compile.log >&2
      echo "peers.sh: LAMMPS $version could not be fetched or compiled; the end of the log is above" >&2
      exit 1
    }
    mkdir -p "$(dirname "$compiled")"
    cp lammps-*/src/lmp_serial "$compiled.part"
    mv "$compiled.part" "$compiled"
  fi
  echo "LAMMPS-native: $(g++ --version | head -n 1), $flags ($(echo "$target" | awk '$1 == "-march=" {print $2}'))"
fi

# run PROGRAM INPUT SKIN
run() {
  input=$2
  case $1 in
    LAMMPS) command=lmp ;;
    LAMMPS-native) command=$compiled ;;
    LAMMPS-native-omp) command="$compiled -sf omp -pk omp 1" ;;
    LIGGGHTS) command=liggghts input=liggghts-$2 ;;
  esac
  # shellcheck disable=SC2086  # a program and its options
  $command -in "$input.in" -var skin "$3" -var name "$1-$3" >"$1-$3.out" 2>&1 || { tail "$1-$3.out" >&2; exit 1; }
}
# each FUNCTION calls it with every program and skin.
each() { for program in $programs; do for skin in $skins; do "$1" "$program" "$skin"; done; done; }

trajectory() { run "$1" free "$2"; }
each trajectory
"$bench" compare "$folder" "$grains" "$simd"

# "Loop time of T on 1 procs for S steps with A atoms", "U% CPU use": the rate of the grains alone, without wall grains, in
# processor time, so that other programs on the machine matter less. LIGGGHTS prints no use; its time is the clock's.
rate() {
  run "$1" speed "$2"
  awk -v n="$grains" '/^Loop time/ && $9 > 1 {time = $4; steps = $9; use = 100}
    /CPU use/ && steps > 0 {use = $1}
    /^Loop time/ && $9 == 0 {exit}
    END {printf "%.4f\n", n * steps / (time * use / 100) * 1e-6}' "$1-$2.out" >>"$1-$2.rates"
}
for _ in $(seq "$rounds"); do
  "$bench" ours "$folder" "$grains" "$simd" >>shearcell.rates
  each rate
done

summary() {
  sort -g | awk '{v[NR] = $1} END {printf "%7.2f (%.2f to %.2f)\n", v[int((NR + 1) / 2)], v[1], v[NR]}'
}
row() { printf '  %-18s skin %-5s %s\n' "$1" "$2" "$(summary <"$1-$2.rates")"; }
echo "N = $grains, million particle-steps/s of one core, $rounds rounds in turn: median (slowest to fastest)"
echo "  shearcell                     $(summary <shearcell.rates)"
each row | tee rows
echo "ours over theirs at its best skin: median (smallest to largest) of the rounds' ratios"
for program in $programs; do
  best=$(awk -v program="$program" '$1 == program && $4 > rate {rate = $4; skin = $3} END {print skin}' rows)
  paste shearcell.rates "$program-$best.rates" | awk '{print $1 / $2}' >ratios
  printf '  %-18s skin %-5s %s\n' "$program" "$best" "$(summary <ratios)"
done
