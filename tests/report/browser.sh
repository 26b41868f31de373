#!/bin/sh
# Tests in Chromium the report that campaign.sh wrote to FOLDER:
#   sh tests/report/browser.sh FRONT_END FOLDER [check...]
# FRONT_END is the build's folder of the front end, with its node_modules. Screenshots stay in FOLDER.
# Exit code 77: something is not installed, and nothing was tested.
set -eu
front_end=$1 folder=$2
shift 2
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

code=0
node tests/report/browser.mjs "$front_end" "$folder/report.html" "$folder/screenshots" "$@" || code=1
if [ $# -eq 0 ]; then
  node tests/report/browser.mjs "$front_end" "$folder/many.html" "$folder/screenshots" || code=1
fi
exit $code
