#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of results, from the verdicts that are committed beside the figures.

    python3 results_table.py README.md RESULTS_FOLDER [--write]

README.md has one row for each claim of HEADLINES, RESULTS_FOLDER/claims.csv a row for every claim.
Ends with code 1 if a table (in README.md, between the marks) differs from the verdicts, which --write mends, or if
published.txt lists other folders than there are.
"""
import csv
import difflib
import io
import json
import math
import pathlib
import re
import sys

BEGIN = "<!-- results, by tests/docs/results_table.py -->\n"
END = "<!-- end of results -->\n"

# The rows of README.md, one claim each: figure, id (in older manifests: name), the cells "claim" and "supplement", and
# perhaps words in place of the verdict.
HEADLINES = [
    ("S1", "S1.fall", "fall of the uncorrected phi (Eq. S2) as k grows a hundredfold", "about 2 %"),
    ("S3", "S3_overlap", "mean overlap [d]", "less than 0.001"),
    ("S2", "S2.percentage", "change of the percentage of crystalline grains if the fluid moves with the cell", "none"),
    ("B5", "B5.offset", "gain of phi by pauses after each cycle", "positive"),
    ("summary", "summary.percentage",
     "percentage of crystalline grains: standard deviation between experiments that differ in drag, time step, pauses or walls "
     "(claim chosen after the runs)",
     "negligible"),
    ("S5a", "S5a.onset@amplitude_rad=0.05", "phi at the onset, A = 0.05", "0.646 +- 0.001"),
    ("S5b", "S5b.slope", "slope of phi at the onset against ln N, where N is the number of interior grains (3389 to 13910)",
     "none from 6000 grains on"),
    ("summary", "summary.core_exponent",
     "nucleation rate proportional to (number of core grains)^b: the exponent b, from the runs of all experiments (claim chosen after the runs)",
     "1 (homogeneous)"),
    ("C", "C.critical_size@amplitude_rad=0.0833",
     "critical size [grains], A = 0.0833: equal numbers of crystallites of this size grow and shrink", "about 16"),
    ("committor", "committor.size@amplitude_rad=0.0833",
     "critical size [grains], A = 0.0833: many runs start from the same state, each with its own small noise; a crystallite of this size grows in half of these runs",
     "16, by the definition in the row above", "another observable"),
    ("S7", "S7.inner", "share of nuclei in the inner half of the width minus the share in the outer half", "0"),
    ("S7", "S7.top", "share of nuclei in the upper third of the height minus the share in the lower third", "over 0.2"),
]
# Beginnings of other folders than the campaign's; a claim is shown as the campaign measured it, or else the first of these.
SOURCES = ("second", "earlier/decide", "earlier/volume", "desk", "earlier")
FIGURES = ("S1", "S2", "S3", "S4", "B5", "C", "S5a", "S5b", "S6", "S7", "nucleation", "nucleation_core",
           "walls", "choices", "accuracy")

# How a quantity of a verdict is shown: the pattern of its name, what converts its value, and a unit.
SHOWN = [
    (r"relative fall of .* (?:less|minus) ([\d.]+)", lambda value, base: 100 * (value + base), " %"),
    (r"phi at the onset (?:less|minus) ([\d.]+)", lambda value, base: value + base, ""),
    (r"relative difference from ([\d.]+)", lambda value, base: base * (1 + value), ""),
    (r"exponent of the rate against \w+ (?:less|minus) ([\d.]+)", lambda value, base: value + base, ""),
    (r"log2 of the ratio", lambda value, base: 2**value, ""),
    (r"relative difference", lambda value, base: 100 * value, " %"),
    (r"percentage", lambda value, base: value, " points"),
]


def digits(value):
    return "unbounded" if value is None else f"{value:.3g}"


def conversion(quantity):
    for pattern, convert, unit in SHOWN:
        if found := re.search(pattern, quantity):
            base = float(found[1]) if found.groups() else None
            return lambda value: convert(value, base), unit
    return lambda value: value, ""


def measured(claim):
    """The estimate with its interval, in the unit in which the supplement states the quantity."""
    if claim["estimate"] is None:
        return "not measured"
    convert, unit = conversion(claim["quantity"])
    ends = [None if end is None else convert(end) for end in claim["interval"] or (None, None)]
    value = convert(claim["estimate"])
    if ends == [None, None]:
        return f"{digits(value)}{unit} (unbounded)"
    if None in ends:
        return f"{digits(value)}{unit} ({digits(ends[0])} to {digits(ends[1])})"
    width = min(abs(end - value) for end in ends)
    # The last digit is the first digit of half the way to the nearer end.
    decimals = 3 if width == 0 else max(0, -math.floor(math.log10(width / 2)))
    level = f"; {100 * claim['level']:.1f} % interval" if claim.get("level", 0.9) != 0.9 else ""
    return f"{value:.{decimals}f}{unit} ({ends[0]:.{decimals}f} to {ends[1]:.{decimals}f}{level})"


def margin(claim):
    """In the unit of `measured`."""
    if "log2 of the ratio" in claim["quantity"]:
        return f"factor {2 ** claim['margin']:g}"
    convert, unit = conversion(claim["quantity"])
    return f"{convert(claim['margin']) - convert(0):.3g}{unit}"


def runs(claim):
    return f"{claim['runs']} of {claim['runs_needed']}" if claim["runs_needed"] else str(claim["runs"])


def position(order, name):
    return order.index(name) if name in order else len(order)


def row(cells):
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def header(names):
    return row(names) + "|" + "---|" * len(names) + "\n"


def verdicts(results):
    """(place below the results, figure, its drawing, claim) for every claim."""
    for path in sorted(results.glob("**/*.verdict.json")):
        figure = path.name.split(".")[0]
        drawing = min(path.parent.glob(f"{figure}*.svg"), default=path)  # a claim of a manifest has none
        for claim in json.loads(path.read_text())["claims"]:
            yield path.parent.relative_to(results).as_posix(), figure, drawing, claim


def best_of(found):
    """Of (place, drawing, claim): a primary claim as the second look measured it; else as the campaign measured the
    claim, whose folders have the names of figures; else the first of SOURCES, and there the one with the most runs."""
    def rank(one):
        place, _, claim = one
        if place.startswith("second/") and claim.get("primary"):
            return claim["estimate"] is None, -2, 0
        source = next((k for k, beginning in enumerate(SOURCES) if place.startswith(beginning)), -1)
        return claim["estimate"] is None, source, -claim["runs"]
    return min(found, key=rank)


def headlines(page, results):
    text = header(["claim", "supplement", "ours (90 % interval)", "margin", "packings", "verdict"])
    for figure, identity, name, supplement, *instead in HEADLINES:
        found = [(place, drawing, claim) for place, of, drawing, claim in verdicts(results)
                 if of == figure and claim.get("id") == identity]
        if found:
            _, drawing, claim = best_of(found)
            text += row([name, supplement, measured(claim), margin(claim), runs(claim),
                         link(instead[0] if instead else claim["verdict"], drawing, page)])
    return text


def link(text, drawing, page):
    return f"[{text}]({drawing.relative_to(page.parent).as_posix()})"


def in_order(figure, claim):
    """Sorts claims by figure, then by text with numbers by their value."""
    return position(FIGURES, figure), re.sub(r"\d+(\.\d+)?", lambda number: f"{float(number[0]):012.6f}", claim)


def all_claims(page, results):
    """A row for each claim; its last cell has what other folders' runs gave."""
    rows = [["figure", "id", "claim", "quantity", "measured (90 % interval)", "margin", "runs", "verdict", "folder",
             "other folders: estimate, verdict (runs)"]]
    asked = {}  # by figure and claim
    for place, figure, drawing, claim in verdicts(results):
        asked.setdefault((figure, claim["claim"]), []).append((place, drawing, claim))
    for (figure, name), found in sorted(asked.items(), key=lambda item: in_order(*item[0])):
        best = best_of(found)
        folder, _, claim = best
        low, high = claim["interval"] or (None, None)
        is_measured = claim["estimate"] is not None
        value = f"{digits(claim['estimate'])} ({digits(low)} to {digits(high)})" if is_measured else "not measured"
        others = []
        for place, _, one in (one for one in found if one != best and one[2]["estimate"] is not None):
            at = "" if one["margin"] == claim["margin"] else f" at a margin of {digits(one['margin'])}"
            others.append(f"{place}: {digits(one['estimate'])}, {one['verdict']}{at} ({runs(one)})")
        rows.append([figure, claim.get("id", ""), name, claim["quantity"], value, digits(claim["margin"]), runs(claim), claim["verdict"], folder,
                     "; ".join(others)])
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def unlisted(results):
    """Folders of figures without a line in published.txt, and lines without a folder."""
    lines = [line for line in (results / "published.txt").read_text().splitlines() if not line.startswith("#")]
    listed = {line.split("|")[0].strip() for line in lines}
    drawn = {path.parent.relative_to(results).as_posix() for path in results.glob("**/*.lineage.json")}
    return sorted(place for place in listed ^ drawn if not place.startswith("earlier/"))


def main():
    readme, results = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    faults = [f"published.txt does not fit the folder {folder}" for folder in unlisted(results)]
    for page, make in ((readme, headlines), (results / "claims.csv", all_claims)):
        text = page.read_text()
        begin, end = (text.index(BEGIN) + len(BEGIN), text.index(END)) if make == headlines else (0, len(text))
        wanted = make(page, results)
        if "--write" in sys.argv[3:]:
            page.write_text(text[:begin] + wanted + text[end:])
        elif text[begin:end] != wanted:
            faults += difflib.unified_diff(text[begin:end].splitlines(), wanted.splitlines(), str(page), "the verdicts",
                                           n=0, lineterm="")
            faults.append("`results_table.py README.md RESULTS --write` makes them the same.")
    if faults:
        sys.exit("\n".join(faults))


main()
