#!/bin/sh
# Runs two cycles of every manifest at scale smoke, and one whose texts are hostile, and writes the report of all,
# all.html:
#   sh tests/report/campaign.sh PROGRAM FOLDER
# The report of the experiments that differ in what a page shows, report.html, is for browser.sh: each of its checks
# opens the page. Both stay in FOLDER, with the store and the log.
set -eu
program=$1 folder=$2
cd "$(dirname "$0")/../.."

rm -rf "$folder"
mkdir -p "$folder"
"$program" run experiments/*.yaml --scale smoke --cycles 2 --store "$folder/store" >/dev/null 2>"$folder/run.log"

# Texts that would be markup if they were let.
hostile="$folder/<img src=x onerror=spoiled=true>.yaml"
cat >"$hostile" <<'MANIFEST'
# </pre></script><script>spoiled = true</script><!-- <script>
experiment: hostile
question: "</script><img src=x onerror='spoiled=true'>&lt;!-- <script>spoiled=true</script>"
figures: [S2]
base: {grains: 300, period_s: 1, steps_per_cycle: 10000, settle_time_step_s: 1.0e-4, cycles: 1}
sweep: {grid: {fluid: [cell, still]}}
labels: {"fluid=still": "<img src=x onerror='spoiled=true'>", "fluid=cell": "<a href='https://example.org'>%{x}</a>"}
plots: [{name: hostile_labels, y: phi, x: cycle}]
scales: {smoke: {}}
MANIFEST
"$program" run "$hostile" --scale smoke --store "$folder/store" >/dev/null 2>>"$folder/run.log"

"$program" report --scale smoke --store "$folder/store" --out "$folder/all.html"
size=$(wc -c <"$folder/all.html")
[ "$size" -lt 15000000 ] || { echo "the report of all experiments has $size bytes" >&2; exit 1; }
set --
for experiment in critical_size drag gravity nucleation_sites onset_amplitude spring_constant system_size hostile; do
  set -- "$@" --experiment "$experiment"
done
"$program" report --scale smoke "$@" --store "$folder/store" --out "$folder/report.html"
