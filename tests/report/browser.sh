#!/bin/sh
# Runs every manifest at scale smoke, writes the report, and looks at it in Chromium:
#   sh tests/report/browser.sh PROGRAM FRONT_END FOLDER
# FRONT_END is the build's folder of the front end, with its node_modules. Screenshots and the report
# stay in FOLDER. Exit code 77: something is not installed, and nothing was tested.
set -eu
program=$1 front_end=$2 folder=$3
cd "$(dirname "$0")/../.."

skip() {
  echo "skipped: $1"
  exit 77
}
command -v node >/dev/null 2>&1 || skip "Node is not installed (Debian package nodejs)"
CHROMIUM=${CHROMIUM:-$(command -v chromium || true)}
[ -n "$CHROMIUM" ] || skip "Chromium is not installed (Debian package chromium)"
[ -s "$front_end/bundle/report.js" ] || skip "the program was built without the report's front end"
[ -d "$front_end/node_modules/playwright-core" ] || skip "npm did not install playwright-core"
export CHROMIUM

rm -rf "$folder"
mkdir -p "$folder"
"$program" run experiments/*.yaml --scale smoke --store "$folder/store" >/dev/null 2>"$folder/run.log"

# Texts that would be markup if they were let.
hostile="$folder/<img src=x onerror=spoiled=true>.yaml"
cat >"$hostile" <<'MANIFEST'
# </pre></script><script>spoiled = true</script><!-- <script>
experiment: hostile
question: "</script><img src=x onerror='spoiled=true'>&lt;!-- <script>spoiled=true</script>"
figures: [S2]
base: {grains: 300, period_s: 1, steps_per_cycle: 10000, settle_time_step_s: 1.0e-4, cycles: 1}
MANIFEST
"$program" run "$hostile" --store "$folder/store" >/dev/null 2>>"$folder/run.log"

"$program" report --scale smoke --store "$folder/store" --out "$folder/report.html"
node tests/report/browser.mjs "$front_end" "$folder/report.html" "$folder/screenshots"
