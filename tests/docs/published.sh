#!/bin/sh
# Every line of published.txt must name a manifest, a scale and variants that exist, and the campaign must cost at most a
# night on two cores, 1.5e13 particle-steps:
#   sh published.sh PROGRAM RESULTS_FOLDER      # absolute paths
set -eu
cd "$2/../.."
grep -v '^#' "$2/published.txt" | while IFS='|' read -r folder manifest options of_run _; do
  # shellcheck disable=SC2086,SC2116,SC2046  # one word an option
  "$1" plan "$2/../"$(echo $manifest) $options $of_run --store /nonexistent > /dev/null || {
    echo "published.txt: the line of $folder is wrong"
    exit 1
  }
done
manifests=$(ls "$2"/../*.yaml | grep -v accuracy.yaml)
# shellcheck disable=SC2086
"$1" plan $manifests --scale paper --store /nonexistent --json 2> /dev/null | python3 -c '
import json, sys
steps = json.load(sys.stdin)["particle_steps_left"]
sys.exit(f"the campaign takes {steps:.3g} particle-steps" if not 1e12 < steps < 1.5e13 else 0)'
