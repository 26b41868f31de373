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
ORDER = ["S1", "S2", "S3", "B5", "S4", "C", "S5a", "S5b", "S6", "S7", "walls", "choices", "table1"]


def cell(text):
    return str(text).replace("|", "\\|")


def measured(claim):
    if "estimate" not in claim:  # written before claims had intervals
        if claim.get("value") is None:
            return claim["note"] or "not measured"
        limit = "" if claim.get("limit") is None else f" (limit {claim['limit']:.3g})"
        note = f"; {claim['note']}" if claim["note"] and len(claim["note"]) < 160 else ""
        return f"{claim['quantity']}: {claim['value']:.3g}{limit}{note}"
    text = f"{claim['quantity']}: not measured"
    if claim["estimate"] is not None:
        low, high = ("unbounded" if end is None else f"{end:.3g}" for end in claim["interval"])
        text = f"{claim['quantity']}: {claim['estimate']:.3g}, interval {low} to {high}"
    needed = f" of {claim['runs_needed']} needed" if claim["runs_needed"] else ""
    note = f"; {claim['note']}" if claim["note"] else ""
    return f"{text}, margin {claim['margin']:.3g}, {claim['runs']} runs{needed}{note}"


def table(page, results):
    rows = ["| figure | claim | measured | verdict |\n", "|---|---|---|---|\n"]
    verdicts = {path.name.split(".")[0]: path for path in results.glob("*.verdict.json")}
    unknown = set(verdicts) - set(ORDER)
    if unknown:
        sys.exit(f"no place in the table for {sorted(unknown)}")
    for figure in filter(verdicts.get, ORDER):
        folder = results.relative_to(page.parent)
        drawings = sorted(results.glob(f"{figure}*.svg"))
        links = " ".join(f"[{path.stem}]({folder / path.name})" for path in drawings
                         if path.stem == figure or not path.stem[len(figure)].isalnum()
                         or path.stem[len(figure):].isalpha())
        for claim in json.loads(verdicts[figure].read_text())["claims"]:
            rows.append(f"| {links} | {cell(claim['claim'])} | {cell(measured(claim))} "
                        f"| {claim['verdict']} |\n")
            links = ""
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
