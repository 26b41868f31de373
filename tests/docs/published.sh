#!/bin/sh
# Every line of published.txt must name a manifest, a scale and variants that exist:
#   sh published.sh PROGRAM RESULTS_FOLDER
set -eu
grep -v '^#' "$2/published.txt" | while IFS='|' read -r folder manifest options of_run _; do
  # shellcheck disable=SC2086,SC2116,SC2046  # one word an option
  "$1" plan "$2/../"$(echo $manifest) $options $of_run --store /nonexistent > /dev/null || {
    echo "published.txt: the line of $folder is wrong"
    exit 1
  }
done
