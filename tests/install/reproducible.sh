#!/bin/sh
# Builds a commit twice, in folders of different names and depths, and compares every installed byte:
#   sh tests/install/reproducible.sh [COMMIT]          HEAD unless another is named
#   sh tests/install/reproducible.sh COMMIT BUILD      builds once and compares with BUILD (preset release)
# The first build is of an archive, the second of a clone, in a folder outside of it. Both use the same compiler,
# libraries and npm packages, and no compiler cache. Two builds take ten minutes on two cores.
set -eu
cd "$(dirname "$0")/../.."
commit=$(git rev-parse "${1:-HEAD}^{commit}")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
CCACHE_DISABLE=1
export CCACHE_DISABLE
unset CXXFLAGS CFLAGS LDFLAGS

build() {  # source, build folder
  cmake -G Ninja -S "$1" -B "$2" -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON -DSHEARCELL_TESTS=OFF \
    -DCMAKE_CXX_COMPILER_LAUNCHER= > "$folder/log" || { cat "$folder/log"; exit 1; }
  cmake --build "$2" ${JOBS:+-j "$JOBS"} > "$folder/log" || { cat "$folder/log"; exit 1; }
}

mkdir -p "$folder/one"
git archive "$commit" | tar -x -C "$folder/one"
build "$folder/one" "$folder/one/build/release"
if [ $# -gt 1 ]; then
  other=$2
else
  git clone -q --no-checkout . "$folder/two/deeper/by/some/folders"
  git -C "$folder/two/deeper/by/some/folders" checkout -q --detach "$commit"
  other="$folder/two/out"
  build "$folder/two/deeper/by/some/folders" "$other"
fi

cmake --install "$folder/one/build/release" --prefix "$folder/a" > /dev/null
cmake --install "$other" --prefix "$folder/b" > /dev/null
diff -r "$folder/a" "$folder/b" || { echo "the builds differ"; exit 1; }
cmp "$folder/one/build/release/shearcell" "$other/shearcell"
"$folder/a/bin/shearcell" --version | head -1 | grep -F "($(echo "$commit" | cut -c1-12))"
! grep -rqF "$folder" "$folder/a" || { echo "a path of this machine was built in:"; grep -rlF "$folder" "$folder/a"; exit 1; }
(cd "$folder/a" && find . -type f | wc -l | sed 's/$/ files, each the same bytes in both/')
sha256sum "$folder/a/bin/shearcell" | cut -d' ' -f1 | sed 's/^/bin\/shearcell /'
