#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the published verdicts again, with numpy, from the numbers that entered them (NAME.verdict.csv):

    python3 recompute.py RESULTS_FOLDER

A mean is recomputed with Student's t, a difference with that of the pairs of one packing, or with Welch's. Ends with
code 1 if an estimate, an interval or a ruling differs, or if a primary claim is of another kind.
"""
import csv
import json
import pathlib
import re
import sys

import numpy as np


def t_quantile(freedom, probability=0.95):
    """Of Student's t, by integrating its density."""
    t = np.linspace(0, 200, 4_000_001)
    density = (1 + t * t / freedom) ** (-(freedom + 1) / 2)
    area = np.cumsum((density[1:] + density[:-1]) / 2)
    return t[1 + np.searchsorted(area / area[-1], 2 * probability - 1)]


def by_packing(rows):
    """One number for each packing: the mean of its runs."""
    packings = {}
    for row in rows:
        if row["value"]:
            packings.setdefault(row["packing"], []).append(float(row["value"]))
    return {packing: np.mean(values) for packing, values in packings.items()}


def estimate(claim, rows):
    """The estimate and half the length of its interval."""
    groups = [by_packing([row for row in rows if row["group"] == name]) for name in dict.fromkeys(r["group"] for r in rows)]
    relative = "relative" in claim["quantity"]
    if len(groups) == 1:
        published = re.search(r"(?:less|from) (\d[\d.e-]*)", claim["quantity"])
        values = np.array(list(groups[0].values())) - (float(published[1]) if published else 0)
        scale = float(published[1]) if published and "relative difference from" in claim["quantity"] else 1
    else:
        a, b = groups
        scale = np.mean(list(b.values())) if relative else 1
        shared = [packing for packing in a if packing in b]
        if not shared:  # Welch
            a, b = (np.array(list(group.values())) for group in groups)
            va, vb = a.var(ddof=1) / len(a), b.var(ddof=1) / len(b)
            freedom = (va + vb) ** 2 / (va**2 / (len(a) - 1) + vb**2 / (len(b) - 1))
            return (a.mean() - b.mean()) / scale, t_quantile(freedom) * np.sqrt(va + vb) / scale
        values = np.array([a[packing] - b[packing] for packing in shared])
    values = values / scale
    return values.mean(), t_quantile(len(values) - 1) * values.std(ddof=1) / np.sqrt(len(values))


def ruling(claim):
    low, high = claim["interval"]
    margin = claim["margin"]
    if claim["verdict"] in ("supported", "refuted"):  # of a direction, which may be either
        return claim["verdict"] if low > margin or high < margin else "undecided"
    if -margin <= low and high <= margin:
        return "agrees"
    return "differs" if high < -margin or low > margin else "undecided"


def main():
    checked, faults = 0, []
    for path in sorted(pathlib.Path(sys.argv[1]).glob("**/*.verdict.csv")):
        if path.parent.name == "cost":  # times, and differences of 1e-16
            continue
        entered = list(csv.DictReader(path.open()))
        for claim in json.loads(path.with_suffix(".json").read_text())["claims"]:
            rows = [row for row in entered if row["claim"] == claim["claim"]]
            if claim["estimate"] is None:
                continue
            if not rows or "value" not in rows[0] or "log2" in claim["quantity"]:
                if claim.get("primary"):
                    faults.append(f"{path}: {claim['claim']}: not recomputed")
                continue
            checked += 1
            value, half = estimate(claim, rows)
            low, high = claim["interval"]
            allowed = 1e-3 * (high - low)
            if not np.allclose([claim["estimate"], low, high], [value, value - half, value + half], rtol=0, atol=allowed):
                faults.append(f"{path}: {claim['claim']}: {value:.6g} +- {half:.6g}, published {claim['estimate']}, {low} to {high}")
            if ruling(claim) != claim["verdict"]:
                faults.append(f"{path}: {claim['claim']}: {claim['verdict']} does not follow from the interval")
    print(f"{checked} verdicts recomputed")
    sys.exit("\n".join(faults) if faults or checked == 0 else 0)


main()
