# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the outcomes of the hard cases, from ctest's results: python3 table.py RESULTS.xml OUTCOMES.csv [check]
OUTCOMES.csv has a row for cases that differ in their numbers alone, with what came of the last of them. Prints a table in
Markdown with a row for each expected outcome. With `check` the file is not written, and other content is an error."""

import csv
import io
import pathlib
import re
import sys
import xml.etree.ElementTree as xml


def in_order(case):
    """k-10 comes after k-1 and before k-100."""
    return [(float(part), "") if number else (0.0, part)
            for part, number in re.findall(r"((\d+(?:\.\d+)?(?:e[-+]?\d+)?)|[^\d]+)", case["case"])]


NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e[-+]?\d+)?(?!\w)")


def with_all_numbers(texts):
    """["at 0.1 of 1", "at 0.3 of 1"] -> "at 0.1, 0.3 of 1"."""
    numbers = iter(zip(*(NUMBER.findall(text) for text in texts)))
    return NUMBER.sub(lambda _: ", ".join(dict.fromkeys(next(numbers))), texts[0])


cases = []
for test in xml.parse(sys.argv[1]).getroot().iter("testcase"):
    said = dict(line.split(": ", 1) for line in (test.findtext("system-out") or "").splitlines() if ": " in line)
    case = {key: said.get(key, "") for key in ("case", "computed", "expected", "came")}
    failure = test.find("failure")
    if failure is not None:
        case["came"] = f"**not as expected**: {case['came'] or failure.get('message')}"
    case["case"] = case["case"] or test.get("name")
    cases.append(case | {"right": failure is None})
cases.sort(key=in_order)
rows = {}
for case in cases:
    alike = case["expected"] if case["right"] else case["case"]
    rows.setdefault((NUMBER.sub("#", case["computed"]), alike), []).append(case)

text = io.StringIO()
table = csv.writer(text, lineterminator="\n")
table.writerow(["computed", "cases", "expected", "came of the last case"])
expected = {}  # what is computed, by what is expected of it
for row in rows.values():
    computed, last = with_all_numbers([case["computed"] for case in row]), row[-1]
    table.writerow([computed, len(row), last["expected"], last["came"]])
    expected.setdefault(last["expected"] if last["right"] else last["came"], []).append(computed)
file = pathlib.Path(sys.argv[2])
if sys.argv[3:] != ["check"]:
    file.write_text(text.getvalue())
elif file.read_text() != text.getvalue():
    new = [line for line in text.getvalue().splitlines() if line not in file.read_text().splitlines()]
    sys.exit(f"{file} has other outcomes than this run, which has:\n" + "\n".join(new))

print("<!-- outcomes -->")
print(f"{sum(case['right'] for case in cases)} of {len(cases)} cases ended as expected.\n")
print("| computed | expected |\n|---|---|")
for outcome, computed in expected.items():
    print("| " + " | ".join(cell.replace("|", r"\|") for cell in ("; ".join(computed), outcome)) + " |")
print("<!-- end -->")
