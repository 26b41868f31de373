#!/bin/sh
# Runs two cycles of every manifest at scale smoke, one manifest whose texts are hostile, and one with 105 runs, and
# writes three reports:
#   sh tests/report/campaign.sh PROGRAM FOLDER
# report.html has the experiments that differ in what a page shows, many.html the 105 runs; browser.sh opens both.
# all.html has all experiments. The reports stay in FOLDER, with the stores and the log.
set -eu
program=$1 folder=$2
cd "$(dirname "$0")/../.."

rm -rf "$folder"
mkdir -p "$folder"
run() {
  "$program" run "$@" --scale smoke --store "$folder/store" >/dev/null 2>>"$folder/run.log"
}

# Texts that would be markup if they were not escaped.
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
for name in choices critical_size drag gravity nucleation_sites onset_amplitude spring_constant system_size; do
  set -- "$@" "experiments/$name.yaml"
done
shift 2  # the arguments of this script
run "$@" --cycles 2
run "$hostile"
"$program" report --scale smoke --store "$folder/store" --out "$folder/report.html"

"$program" run tests/report/many.yaml --store "$folder/many" >/dev/null 2>>"$folder/run.log"
"$program" report --store "$folder/many" --out "$folder/many.html" 2>>"$folder/run.log"

run experiments/*.yaml --cycles 2
"$program" report --scale smoke --store "$folder/store" --out "$folder/all.html"
size=$(wc -c <"$folder/all.html")
[ "$size" -lt 15000000 ] || { echo "the report of all experiments has $size bytes" >&2; exit 1; }
