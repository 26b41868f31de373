#!/bin/sh
# Compares the committed reference with what the program prints: sh reference.sh PROGRAM experiments/REFERENCE.md
set -eu
if ! "$1" manual | diff -u "$2" - >&2; then
  echo "$2 is out of date. Run \`shearcell manual > experiments/REFERENCE.md\`." >&2
  exit 1
fi
