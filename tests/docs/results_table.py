#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of results in README.md, from the verdicts that are committed beside the figures.

    python3 results_table.py README.md RESULTS_FOLDER [--write]

Without --write it ends with code 1 if the table between the marks differs from the verdicts.
"""
import json
import pathlib
import sys

BEGIN = "<!-- results, by tests/docs/results_table.py -->\n"
END = "<!-- end of results -->\n"


def number(value):
    return "unbounded" if value is None else f"{value:.3g}"


def row(claim, link):
    low, high = claim["interval"] or (None, None)
    measured = "not measured"
    if claim["estimate"] is not None:
        measured = f"{number(claim['estimate'])} ({number(low)} to {number(high)})"
    runs = str(claim["runs"])
    if claim["runs_needed"]:
        runs += f" of {claim['runs_needed']}"
    cells = [link, claim["claim"], claim["quantity"], measured, number(claim["margin"]), runs, claim["verdict"]]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def table(page, results):
    rows = ["| figure | claim | quantity | measured (90 % interval) | margin | runs | verdict |\n", "|---|---|---|---|---|---|---|\n"]
    for path in sorted(results.glob("**/*.verdict.json")):
        figure = path.name.split(".")[0]
        drawings = sorted(path.parent.glob(f"{figure}*.svg"))
        place = path.parent.relative_to(results)
        link = f"[{place}/{figure}]({drawings[0].relative_to(page.parent)})"
        for claim in json.loads(path.read_text())["claims"]:
            rows.append(row(claim, link))
            link = ""
    return "".join(rows)


page, results = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
text = page.read_text()
begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
wanted = table(page, results)
if "--write" in sys.argv[3:]:
    page.write_text(text[:begin] + wanted + text[end:])
elif text[begin:end] != wanted:
    sys.exit(f"{page.name} says\n{text[begin:end]}\nand the verdicts in {results} say\n{wanted}\n"
             "`results_table.py README.md RESULTS --write` makes them the same.")
