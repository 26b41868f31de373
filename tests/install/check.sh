#!/bin/sh
# Installs the build, builds a consumer on it, and unpacks the Debian package.
#   sh check.sh BUILD_FOLDER SOURCE_FOLDER
set -eu
build=$1
source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

(umask 077 && cmake --install "$build" --prefix "$folder/prefix") > "$folder/log" || { cat "$folder/log"; exit 1; }
closed=$(find "$folder/prefix" ! -perm -o=r -o -type d ! -perm -o=x)
[ -z "$closed" ] || { echo "others cannot read: $closed"; exit 1; }
for file in bin/shearcell share/shearcell/experiments/drag.yaml \
            share/shearcell/shearcell.cdx.json \
            lib/python3/dist-packages/shearcell/store.py include/shearcell/core/simulation.hpp; do
  [ -s "$folder/prefix/$file" ] || { echo "not installed: $file"; exit 1; }
done
# A manual page for the program and for each command.
if command -v help2man > /dev/null; then
  for page in shearcell $("$folder/prefix/bin/shearcell" --help | sed -n '/^Compute:/,/^Examples:/s/^  \([a-z]\+\)  .*/shearcell-\1/p'); do
    [ -s "$folder/prefix/share/man/man1/$page.1" ] || { echo "not installed: the manual page $page"; exit 1; }
    if command -v groff > /dev/null; then
      [ -z "$(groff -man -Tutf8 -ww -W break -z "$folder/prefix/share/man/man1/$page.1" 2>&1)" ] || { echo "faults in the manual page $page"; exit 1; }
    fi
  done
fi
"$folder/prefix/bin/shearcell" plan "$folder/prefix/share/shearcell/experiments/drag.yaml" \
  --scale smoke --store "$folder/none" | grep -q "4 runs"

# A consumer sees the installed headers alone.
cp -r "$source/tests/install/consumer" "$folder/consumer"
cmake -G Ninja -S "$folder/consumer" -B "$folder/consumer/build" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$folder/prefix" > "$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
cmake --build "$folder/consumer/build" > "$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
"$folder/consumer/build/consumer"

if ! command -v dpkg-shlibdeps >/dev/null; then
  echo "the Debian package was not made: dpkg-dev is not installed"
  exit 0
fi
(cd "$build" && cpack -B "$folder/package") > "$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
dpkg -x "$folder"/package/*.deb "$folder/unpacked"
for field in Package Version Depends Recommends; do
  dpkg -I "$folder"/package/*.deb | grep "^ $field:"
done
"$folder/unpacked/usr/bin/shearcell" --version | grep "^shearcell "
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH="$folder/unpacked/usr/lib/python3/dist-packages" /usr/bin/python3 -c "import shearcell"
[ ! -e "$folder/unpacked/usr/include" ]
