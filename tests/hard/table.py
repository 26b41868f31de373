# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the outcomes of the hard cases as a table in Markdown, from ctest's results: python3 table.py RESULTS.xml
Cases that differ in their numbers alone share a row, which says what came of the last of them."""

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


def in_short(came, expected):
    """Without clauses that `expected` has too, without right values, and of a stop or refusal the numbers alone. Of clauses
    that differ in their numbers alone the last."""
    clauses = {}
    for clause in came.split("; "):
        clause = re.sub(r", right \S+, off by (\S+) \(of (\S+)\)", r", off by \1 (at most \2)", clause)
        clause = re.sub(r"^stopped at (step \d+): .* is (\S+), limit (\S+)$", r"\1: \2, limit \3", clause)
        clauses[NUMBER.sub("#", clause)] = clause
    new = [clause for clause in clauses.values() if clause not in expected]
    return "refused" if came.startswith("refused: ") else "; ".join(new or clauses.values())


cases = []
for test in xml.parse(sys.argv[1]).getroot().iter("testcase"):
    said = dict(line.split(": ", 1) for line in (test.findtext("system-out") or "").splitlines() if ": " in line)
    case = {key: said.get(key, "") for key in ("case", "computed", "expected", "came")}
    failure = test.find("failure")
    if failure is not None:
        case["came"] = f"**not as expected**: {case['came'] or failure.get('message')}"
    case["case"] = case["case"] or test.get("name")
    cases.append({key: text.replace("|", r"\|") for key, text in case.items()} | {"right": failure is None})
cases.sort(key=in_order)
rows = {}
for case in cases:
    alike = case["expected"] if case["right"] else case["case"]
    rows.setdefault((NUMBER.sub("#", case["computed"]), alike), []).append(case)
print("<!-- outcomes -->")
print(f"{sum(case['right'] for case in cases)} of {len(cases)} cases ended as expected.\n")
print("| computed | expected | came of the last case |\n|---|---|---|")
for row in rows.values():
    computed = with_all_numbers([case["computed"] for case in row])
    print(f"| {computed} | {row[-1]['expected']} | {in_short(row[-1]['came'], row[-1]['expected'])} |")
print("<!-- end -->")
