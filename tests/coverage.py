# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of coverage from `llvm-cov export -summary-only`: python3 coverage.py FILE SOURCE_FOLDER"""
import json
import sys
from collections import defaultdict
from pathlib import Path

FOLDERS = ("core", "protocols", "provenance", "analysis", "experiments")
source = Path(sys.argv[2]).resolve()
sums = defaultdict(lambda: [0, 0, 0, 0])
files = []
for entry in json.load(open(sys.argv[1]))["data"][0]["files"]:
    try:
        path = Path(entry["filename"]).resolve().relative_to(source)
    except ValueError:
        continue  # a library's header
    if path.parts[0] not in FOLDERS:
        continue
    folder = "/".join(path.parts[:2]) if path.parts[0] == "experiments" else path.parts[0]
    lines, branches = entry["summary"]["lines"], entry["summary"]["branches"]
    counts = (lines["covered"], lines["count"], branches["covered"], branches["count"])
    for name in (folder, "all"):
        sums[name] = [a + b for a, b in zip(sums[name], counts)]
    files.append((lines["count"] - lines["covered"], lines["count"], str(path)))


def row(name, covered, lines, taken, branches):
    percent = lambda part, whole: f"{100 * part / whole:.1f} %" if whole else "-"
    print(f"| {name:<22} | {lines:>6} | {percent(covered, lines):>7} | {branches:>8} | {percent(taken, branches):>7} |")


print(f"| {'folder':<22} | {'lines':>6} | {'reached':>7} | {'branches':>8} | {'taken':>7} |")
print("|---|---:|---:|---:|---:|")
for name in sorted(sums, key=lambda name: (name == "all", name)):
    row(name, *sums[name])
print("\nMost lines not reached:")
for missed, lines, path in sorted(files, reverse=True)[:15]:
    print(f"{missed:>5} of {lines:>4}  {path}")
