#!/bin/sh
# The manual page of the program or of one of its commands, from its --help:
#   sh manual_page.sh PAGE PROGRAM [COMMAND...]
set -eu
if [ "$1" = --help-of ]; then  # what help2man runs: examples get a prompt, so that it keeps their lines
  shift
  "$@" | sed 's/^  shearcell /  $ shearcell /'
  exit
fi
page=$1
shift
version=$("$1" --version | sed -n '1s/^shearcell \([^ ]*\).*/\1/p')
help2man --no-info --output "$page" --name "$("$@" --help | head -n 1 | tr -d :)" \
  --version-string "$(basename "$page" .1) $version" "sh '$0' --help-of $*"
