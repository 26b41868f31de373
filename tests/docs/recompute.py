#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the published verdicts again, with numpy, from the numbers that entered them (NAME.verdict.csv):

    python3 recompute.py RESULTS_FOLDER

A mean is recomputed with Student's t, a difference with that of the pairs of one packing, or with Welch's; a slope, a
share and a critical size with a bootstrap of its own, whose ends may differ by a tenth of the interval; the exponent of
nucleation by maximum likelihood. Ends with code 1 if an estimate, an interval or a ruling differs, or if a primary
claim is of another kind.
"""
import csv
import json
import math
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
    """The estimate and its interval."""
    groups = [by_packing([row for row in rows if row["group"] == name]) for name in dict.fromkeys(r["group"] for r in rows)]
    relative = "relative" in claim["quantity"]
    if len(groups) == 1:
        published = re.search(r"(?:less|from) (\d[\d.e-]*)", claim["quantity"])
        values = np.array(list(groups[0].values())) - (float(published[1]) if published else 0)
        if published and "relative difference from" in claim["quantity"]:
            values = values / float(published[1])
    else:
        if relative:  # a difference of logarithms
            groups = [{packing: np.log(value) for packing, value in group.items()} for group in groups]
        a, b = groups
        shared = [packing for packing in a if packing in b]
        values = np.array([a[packing] - b[packing] for packing in shared])
        if not shared:  # Welch
            a, b = (np.array(list(group.values())) for group in groups)
            va, vb = a.var(ddof=1) / len(a), b.var(ddof=1) / len(b)
            freedom = (va + vb) ** 2 / (va**2 / (len(a) - 1) + vb**2 / (len(b) - 1))
            mean, half = a.mean() - b.mean(), t_quantile(freedom) * np.sqrt(va + vb)
    if len(groups) == 1 or shared:
        mean, half = values.mean(), t_quantile(len(values) - 1) * values.std(ddof=1) / np.sqrt(len(values))
    ends = np.array([mean, mean - half, mean + half])
    return np.expm1(ends) if len(groups) == 2 and relative else ends


def bootstrap(statistic, parts):
    """The statistic of all parts, and Hesterberg's expanded interval of their bootstrap."""
    count = len(parts)
    tail = (1 - math.erf(t_quantile(count - 1) * math.sqrt(count / (count - 1)) / math.sqrt(2))) / 2
    random = np.random.default_rng(1)
    drawn = sorted(statistic(np.array(parts)[random.integers(0, count, count)]) for _ in range(4000))
    return statistic(np.array(parts)), drawn[round(tail * 3999)], drawn[round((1 - tail) * 3999)]


def slope(points):
    x, y = points.T
    return np.sum((x - x.mean()) * (y - y.mean())) / np.sum((x - x.mean()) ** 2)


def quantile(density, probability):
    """Of a distribution of positive numbers, by integrating its density."""
    x = np.linspace(0, 200, 4_000_001)[1:]
    area = np.cumsum(density(x))
    return x[np.searchsorted(area / area[-1], probability)]


def spread_between(rows):
    """The standard deviation between the means of variants by analysis of variance, 0, and its upper limit: with F of
    the data divided by the 5 % quantile of F's distribution, and the 5 % quantile of chi-squared."""
    groups = {}
    for row in rows:
        groups.setdefault(row["group"], []).append(row)
    groups = [np.array(list(means.values())) for means in map(by_packing, groups.values()) if means]
    sizes = np.array([len(group) for group in groups])
    k, n = len(groups), sizes.sum()
    size = (n - (sizes**2).sum() / n) / (k - 1)
    means = np.array([group.mean() for group in groups])
    between = (sizes * (means - (sizes * means).sum() / n) ** 2).sum() / (k - 1)
    noise = sum(((group - group.mean()) ** 2).sum() for group in groups) / (n - k)
    a, b = (k - 1) / 2, (n - k) / 2
    f = quantile(lambda x: np.exp((a - 1) * np.log(x) - (a + b) * np.log1p(a / b * x)), 0.05)
    chi = quantile(lambda x: np.exp((a - 1) * np.log(x) - x / 2), 0.05)
    root = lambda variance: math.sqrt(max(0, variance) / size)
    return root(between - noise), 0, root((between - f * noise) * (k - 1) / chi)


def share(packings):
    return packings[:, 0].sum() / packings[:, 1].sum()


def critical_size(counts):
    """Where delta_rho, smoothed by lines over ln(size), rises through zero; counts: (run, size, [all, excess])."""
    x = np.log(np.arange(1, 101))
    n, excess = counts.sum(axis=0).T
    away = x[None, :] - x[:, None]
    weight = np.exp(-((away / 0.2) ** 2) / 2)
    w0, w1, w2 = (weight * away**k @ n for k in range(3))
    e0, e1 = (weight * away**k @ excess for k in range(2))
    with np.errstate(invalid="ignore", divide="ignore"):
        scatter = w0 * w2 - w1**2
        delta = np.where(scatter > 1e-9 * w0 * w2, (w2 * e0 - w1 * e1) / scatter, e0 / w0)
    above = np.cumsum(excess[::-1])[::-1]  # of those that grew from a size on
    best, found = 0, np.inf
    if delta[0] > 0 and above[0] > 0:
        best, found = above[0], -np.inf
    for k in np.flatnonzero((delta[:-1] <= 0) & (delta[1:] > 0)) + 1:
        if above[k] > best:
            best, found = above[k], math.exp(x[k - 1] + delta[k - 1] / (delta[k - 1] - delta[k]) * (x[k] - x[k - 1]))
    return found


def growth_counts(rows):
    """(run, size, [all, excess of those that grew]) of each group, by packing."""
    groups = {}
    for row in rows:
        table = groups.setdefault(row["group"], {}).setdefault(row["packing"], np.zeros((100, 2)))
        larger, smaller = (sum(int(row[kind]) for kind in kinds) for kinds in (("grew", "absorbed"), ("shrank", "vanished")))
        table[int(row["size"]) - 1] += [larger + smaller, larger - smaller]
    return [list(group.values()) for group in groups.values()]


def ratio(a, b):
    """a / b of two estimates with their intervals, by Zou and Donner."""
    down = math.hypot(math.log(a[0] / a[1]), math.log(b[2] / b[0]))
    up = math.hypot(math.log(a[2] / a[0]), math.log(b[0] / b[1]))
    return a[0] / b[0], a[0] / b[0] * math.exp(-down), a[0] / b[0] * math.exp(up)


def nucleation(rows):
    """The exponent of rate = c(amplitude, phi) n^a, and the interval of its profile likelihood, whatever packings say."""
    prior = np.array([0, 1 / 9, 4])
    amplitudes = {}
    for row in rows:
        cycles, grains = float(row["cycles"]), float(row["grain_cycles"])
        u = (float(row["phi"]) - 0.646) / 0.002
        amplitudes.setdefault(row["amplitude_rad"], []).append(
            (math.log(cycles), math.log(grains / cycles), int(row["onsets"]), 1, u, u * u))

    def logarithm(exponent):
        total = 0
        for shares in amplitudes.values():
            cycles, size, events, *terms = np.array(shares).T
            if events.sum() == 0:
                continue
            terms = np.array(terms).T
            offset = cycles + exponent * size
            c = np.array([math.log(events.sum() / np.exp(offset - offset.max()).sum()) - offset.max(), 0, 0])
            value = lambda c: (events * (offset + terms @ c) - np.exp(offset + terms @ c)).sum() - c @ (prior * c) / 2
            for _ in range(100):
                expected = np.exp(offset + terms @ c)
                curvature = (terms.T * expected) @ terms + np.diag(prior)
                move = np.linalg.solve(curvature, terms.T @ (events - expected) - prior * c)
                while not value(c + move) >= value(c) and np.linalg.norm(move) > 1e-9:
                    move /= 2
                c = c + move
                if np.linalg.norm(move) < 1e-9:
                    break
            total += value(c)
        return total

    exponents = np.arange(-5, 8, 0.01)
    values = np.array([logarithm(a) for a in exponents])
    inside = exponents[values > values.max() - 2.7055 / 2]  # of chi-squared, one degree of freedom, 90 %
    return exponents[values.argmax()], inside.min(), inside.max()


def expected(claim, rows):
    """Estimate, interval and the error that is allowed in these, or None for a claim of another kind."""
    low, high = claim["interval"]
    drawn = 0.1 * (high - low) if None not in (low, high) else 0
    columns = {column for row in rows for column, text in row.items() if text}  # of this claim
    if "place" in columns:
        packings = {}
        for row in rows:
            packings.setdefault(row["packing"], []).append(float(row["value"]))
        return *bootstrap(share, [(sum(values), len(values)) for values in packings.values()]), drawn
    if "x" in columns:
        return *bootstrap(slope, [(float(row["x"]), float(row["value"])) for row in rows]), drawn
    if "vanished" in columns:
        sizes = [bootstrap(critical_size, group) for group in growth_counts(rows)]
        if len(sizes) == 2:
            return *(value - 1 for value in ratio(sizes[1], sizes[0])), drawn
        published = float(re.search(r"from (\d+)", claim["quantity"])[1])
        again = re.search(r"would give ([\d.]+) to ([\d.]+)", claim["note"])
        if not again:
            return None
        (size, low, high), (least, most) = sizes[0], (float(end) for end in again.groups())
        return *(value - 1 for value in ratio((size, low, high), (published, published * size / most, published * size / least))), drawn
    if "grain_cycles" in columns:
        return *(value - 1 for value in nucleation(rows)), 0.02
    if "standard deviation between variants" in claim["quantity"]:
        return *spread_between(rows), 1e-3 * (high - low)
    if "value" in columns:
        return *estimate(claim, rows), 1e-3 * (high - low)
    return None


def ruling(claim):
    low, high = claim["interval"]
    margin = claim["margin"]
    if claim["verdict"] in ("supported", "refuted"):  # of a direction, which may be either
        return claim["verdict"] if low > margin or high < margin else "undecided"
    if -margin <= low and high <= margin:
        return "agrees"
    return "differs" if high < -margin or low > margin else "undecided"


@np.errstate(over="ignore")  # of steps that Newton's method takes back
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
            again = expected(claim, rows) if rows and "log2" not in claim["quantity"] else None
            if again is None:
                if claim.get("primary"):
                    faults.append(f"{path}: {claim['claim']}: not recomputed")
                continue
            checked += 1
            value, low, high, allowed = again
            published = [claim["estimate"], *claim["interval"]]
            if not np.allclose(np.array(published, float), [value, low, high], rtol=0, atol=allowed):
                faults.append(f"{path}: {claim['claim']}: {value:.6g}, {low:.6g} to {high:.6g}, published {published}")
            if ruling(claim) != claim["verdict"]:
                faults.append(f"{path}: {claim['claim']}: {claim['verdict']} does not follow from the interval")
    print(f"{checked} verdicts recomputed")
    sys.exit("\n".join(faults) if faults or checked == 0 else 0)


main()
