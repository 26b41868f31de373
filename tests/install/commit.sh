#!/bin/sh
# Checks the commit that a build reports: of a clean repository, a changed one, an archive, and of neither.
#   sh commit.sh SOURCE_FOLDER
set -eu
script=$1/experiments/runner/commit.cmake
command -v git > /dev/null || { echo "skipped: git is not installed"; exit 0; }
grep -qF '"$Format:' "$script" || { echo "skipped: these sources are an archive"; exit 0; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
unset GIT_DIR GIT_WORK_TREE GIT_INDEX_FILE
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null

says() {  # folder, what is to be said
  cmake -DSOURCE="$1" -DOUT="$folder/commit.cpp" -P "$1/experiments/runner/commit.cmake"
  grep -qF "kBuildCommit = \"$2\"" "$folder/commit.cpp" || {
    echo "$3: expected $2, got"; cat "$folder/commit.cpp"; exit 1; }
}
put() {  # folder
  mkdir -p "$1/experiments/runner"
  cp "$script" "$(dirname "$script")/.gitattributes" "$1/experiments/runner"
}
record() {  # folder
  git -C "$1" init -q
  git -C "$1" add .
  git -C "$1" -c user.name=t -c user.email=t@example.org commit -q -m "$2"
}

put "$folder/repository"
says "$folder/repository" unknown "no repository, no archive"
record "$folder/repository" first
head=$(git -C "$folder/repository" rev-parse HEAD | cut -c1-12)
says "$folder/repository" "$head" "a clean repository"
before=$(stat -c %Y.%y "$folder/commit.cpp")
touch "$folder/repository/experiments/runner/.gitattributes"
echo new > "$folder/repository/not-tracked"
says "$folder/repository" "$head" "a touched and an untracked file"
[ "$before" = "$(stat -c %Y.%y "$folder/commit.cpp")" ] || { echo "written again though nothing changed"; exit 1; }

# An archive, also where it is unpacked inside another repository.
put "$folder/outer"
record "$folder/outer" second
mkdir "$folder/outer/source" "$folder/source"
for to in "$folder/source" "$folder/outer/source"; do
  git -C "$folder/repository" archive HEAD | tar -x -C "$to"
  says "$to" "$head" "an archive in $to"
done

echo '# changed' >> "$folder/repository/experiments/runner/.gitattributes"
says "$folder/repository" "$head-dirty" "a changed file"
echo "commit: as the repository, its archive and its changes have it"
