# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the outcomes of the hard cases as a table in Markdown, from ctest's results: python3 table.py RESULTS.xml"""

import re
import sys
import xml.etree.ElementTree as xml


def in_order(case):
    """k-10 comes after k-1 and before k-100."""
    return [(float(part), "") if number else (0.0, part)
            for part, number in re.findall(r"((\d+(?:\.\d+)?(?:e[-+]?\d+)?)|[^\d]+)", case["case"])]


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
print("<!-- outcomes -->")
print(f"{sum(case['right'] for case in cases)} of {len(cases)} cases ended as expected.\n")
print("| case | computed | expected | came |\n|---|---|---|---|")
for case in cases:
    print(f"| `{case['case']}` | {case['computed']} | {case['expected']} | {case['came']} |")
print("<!-- end -->")
