#!/bin/sh
# Makes the archive and the wheel that run on any x86-64 Linux with kernel 4 or later, without root or compiler:
#   sh experiments/install/archive.sh OUT            installs what is missing, builds, packs
#   sh experiments/install/archive.sh OUT BUILD      packs what BUILD has, a build folder of this commit
# On Debian 12 or 13. The same commit, compiler, libraries and npm packages give the same bytes.
set -eu
source=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "${1:?names no folder for the archive}"
out=$(cd "$1" && pwd)
cd "$source"
if [ $# -lt 2 ]; then
  sh .ci/setup archive
  cmake --preset release
  cmake --build --preset release --target shearcell shearcell_texts
fi
build=$(cd "${2:-build/release}" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if ! cmake --install "$build" --prefix "$work/installed" --component program --strip > "$work/log"; then
  cat "$work/log"
  exit 1
fi
# Freestanding; a loop must not become a call of memset().
gcc -Wall -Wextra -O2 -static -nostdlib -ffreestanding -fno-pie -no-pie -fno-stack-protector -fcf-protection=none \
  -fno-tree-loop-distribute-patterns -Wl,--build-id=none -Wl,-z,noexecstack -s \
  -o "$work/shearcell" experiments/install/launcher.c
/usr/bin/python3 -B experiments/install/archive.py "$work" "$build" "$out"
