#!/bin/sh
# Makes the archive and the wheel twice, compares their bytes, and uses both where nothing else is installed: the archive
# in a root folder that holds it, /proc, /dev and /tmp alone, the wheel with Python alone.
#   sh archive.sh BUILD_FOLDER SOURCE_FOLDER
set -eu
build=$1
source=$2
for tool in dpkg-query gcc strip help2man /usr/bin/python3; do
  command -v "$tool" > /dev/null || { echo "skipped: $tool is not installed"; exit 77; }
done
[ "$(uname -m)" = x86_64 ] || { echo "skipped: the archive is for x86-64"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
wrong() { echo "$*"; exit 1; }

sh "$source/experiments/install/archive.sh" "$folder/other" "$build" > "$folder/log" 2>&1 &
sh "$source/experiments/install/archive.sh" "$folder/out" "$build"
wait $! || { cat "$folder/log"; exit 1; }
diff -r "$folder/out" "$folder/other" || wrong "the same build gave other bytes"

root=$folder/root
mkdir -p "$root/proc" "$root/dev" "$root/tmp"
tar -xJf "$folder"/out/*.tar.xz -C "$root" --no-same-owner
place=/$(cd "$root" && echo shearcell-*)
for file in man/man1/shearcell-run.1 experiments/drag.yaml experiments/REFERENCE.md licences/sources.txt licences/libc6 \
            licences/common-GPL-3 licences/npm; do
  [ -s "$root$place/$file" ] || wrong "the archive lacks $file"
done
! find "$root$place" -type l | grep . || wrong "links, which some file systems do not have"
for path in "$source" "$build" "$folder"; do
  ! grep -rlaF "$path" "$root$place" || wrong "these files hold the path $path"
done
# Every library has a source and a licence; curl's is not there.
for library in "$root$place"/lib/lib*.so*; do
  grep -qF "\"$(basename "$library")\"" "$root$place/licences/shearcell.cdx.json" ||
    [ "$(basename "$library")" = libcurl.so.4 ] || wrong "$library is not in the bill of materials"
done
! grep -q "^libcurl\|^libldap" "$root$place/licences/sources.txt" || wrong "curl is in the list of sources"

# A command in that root folder, which needs a mount namespace. Without one the machine's libraries are hidden at least
# from what the environment says.
own=""
[ "$(id -u)" -eq 0 ] || own=--map-root-user
if unshare --mount $own true 2> /dev/null; then
  echo "in a root folder with nothing else"
  at=/tmp
  cat > "$folder/shearcell" << END
#!/bin/sh
exec unshare --mount $own sh -c 'mount --rbind /proc "$root/proc" && mount --rbind /dev "$root/dev" &&
  exec env -i PATH="$PATH:/usr/sbin" chroot "$root" $place/shearcell "\$@"' sh "\$@"
END
else
  echo "mount namespaces are not allowed here: used among this machine's files"
  at=$root/tmp
  place=$root$place
  printf '#!/bin/sh\nexec env -i PATH=/nowhere %s/shearcell "$@"\n' "$place" > "$folder/shearcell"
fi
chmod +x "$folder/shearcell"
PATH=$folder:$PATH

manifest=$place/experiments/drag.yaml
shearcell plan "$manifest" --scale smoke --store $at/store | grep "4 runs"
shearcell run "$manifest" --scale smoke --cycles 2 --store $at/store 2> "$folder/said" &
for _ in $(seq 600); do
  grep -q started "$folder/said" && break
  sleep 0.05
done
# The process has the name of the program, not that of its loader. The script, unshare and chroot have become it.
[ "$(cat /proc/$!/comm)" = shearcell ] || wrong "the process is called $(cat /proc/$!/comm)"
kill -INT $!
code=0
wait $! || code=$?
[ $code = 85 ] || { cat "$folder/said"; wrong "Ctrl-C: exit code $code"; }
shearcell resume --store $at/store -q
code=0
shearcell figures S2 --store $at/store --out $at/figures 2> "$folder/said" || code=$?
if [ "$at" = /tmp ]; then
  [ $code = 1 ] || wrong "figures without gnuplot: exit code $code"
  grep -q "no PDF: rsvg-convert" "$folder/said" || wrong "figures did not say that rsvg-convert is missing"
  grep "gnuplot is not installed" "$folder/said" | head -1
fi
for file in S2a.csv S2a.gp S2.caption.txt S2.verdict.json S2.verdict.csv S2.lineage.json; do
  [ -s "$root/tmp/figures/drag/smoke/$file" ] || wrong "figures did not write $file"
done
shearcell report --store $at/store --out $at/report.html
shearcell verify --replay 1 --store $at/store | grep "the same state"
# Jobs of a cluster start the program by its path.
shearcell submit "$manifest" --scale smoke --store $at/none --dry-run | grep -o "job.sh $place/shearcell"
states() { grep -E '"(id|state_hash)"' "$1"; }
shearcell status --json --store $at/store > "$folder/archive.json"
"$build/shearcell" run "$root/${place#"$root"}/experiments/drag.yaml" --scale smoke --cycles 2 --store "$folder/store" -q > /dev/null
"$build/shearcell" status --json --store "$folder/store" > "$folder/build.json"
states "$folder/archive.json" > "$folder/a"
states "$folder/build.json" > "$folder/b"
[ "$(grep -c state_hash "$folder/b")" -ge 4 ]
diff "$folder/a" "$folder/b" && echo "the same bits as the built program"

# The loader splits the path of its libraries at ':' and ';', so the launcher refuses such a path.
mkdir "$folder/a:b"
tar -xJf "$folder"/out/*.tar.xz -C "$folder/a:b" --no-same-owner
code=0
"$folder"/a:b/shearcell-*/shearcell --version 2> "$folder/said" || code=$?
[ $code = 1 ] && grep "must not contain ':' or ';'" "$folder/said" || wrong "a colon in the path: exit code $code"
rm -r "$folder/a:b"

# The wheel, by Debian's Python without network and packages. Its command is a script of a line or two.
if ! /usr/bin/python3 -m pip --version > /dev/null 2>&1; then
  echo "the wheel was not installed: python3-pip is missing"
  exit 0
fi
/usr/bin/python3 -m pip install --no-index --quiet --break-system-packages --target "$folder/site" "$folder"/out/*.whl
cat > "$folder/use.py" << 'END'
import sys

sys.modules.update(dict.fromkeys(("numpy", "h5py", "pandas", "tqdm")))  # importing them fails
import shearcell

store = shearcell.run(sys.argv[1], "smoke", store="wheel-store", cycles=1, seeds=1)
print([run.state for run in store.runs()], store.program)
END
cd "$folder"
env -i HOME="$folder" PATH=/usr/bin:/bin PYTHONPATH="$folder/site" /usr/bin/python3 use.py "$root/${place#"$root"}/experiments/drag.yaml" \
  2> "$folder/said" | grep -F "['completed', 'completed'] $folder/site/shearcell/program/shearcell" || { cat "$folder/said"; exit 1; }
env -i PATH=/usr/bin:/bin PYTHONPATH="$folder/site" "$folder/site/bin/shearcell" --version | grep "^shearcell "
env -i PATH=/usr/bin:/bin PYTHONPATH="$folder/site" "$folder/site/bin/shearcell" status --store wheel-store | grep -c completed
