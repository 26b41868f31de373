#!/bin/sh
# Spell checker for documents, sources and messages: sh spelling.sh FILE_OR_FOLDER...
# Ends with code 1 and prints file, line and proposal for each word that codespell finds. `right` lists words to accept.
set -eu
right="crate,commun,mater,upto,nin,fo,caf,abd,iif,doubleclick"
command -v codespell >/dev/null || { echo "codespell is missing: sh .ci/setup tests" >&2; exit 1; }
find "$@" \( -name node_modules -o -name build -o -name results -o -path '*tests/data' -o -path '*docs/broken' -o -path '*fuzz/regressions' -o -name .git \) -prune \
  -o -type f \( -name '*.md' -o -name '*.[ch]pp' -o -name '*.py' -o -name '*.sh' -o -name '*.js' -o -name '*.cmake' \
  -o -name 'CMakeLists.txt' -o -name '*.yaml' -o -name '*.cff' \) -print0 |
  xargs -0 codespell --ignore-words-list "$right" || exit 1
