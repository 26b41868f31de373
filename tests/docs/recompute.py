#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the published verdicts again, with numpy, from the numbers that entered them (NAME.verdict.csv):

    python3 recompute.py RESULTS_FOLDER

Runs that end before an event are censored: their number is larger than `above`. Means, differences, slopes and the
exponent of nucleation have intervals of the profile likelihood (analysis/censored.hpp), which without censoring are
those of Student and Welch. Beyond the rounding to six digits, their ends may differ by 1e-4 of the interval, and the
limit of a standard deviation between variants by 1e-3. A share and a critical size have a bootstrap with its own random
numbers; ends may differ by a tenth of the interval. Ends with code 1 if an estimate, an interval or a ruling differs,
or if a primary claim is not recomputed.
"""
import csv
import json
import math
import pathlib
import re
import sys
from statistics import NormalDist

import numpy as np


def t_quantile(freedom, level):
    """Where |t| of Student's t lies below with probability `level`. t = sqrt(freedom) tan(angle), and the density of
    the angle is cos(angle)^(freedom - 1)."""
    angle = np.linspace(0, math.pi / 2, 400_001)
    density = np.cos(angle) ** (freedom - 1)
    area = np.concatenate([[0], np.cumsum(density[1:] + density[:-1])])
    return math.sqrt(freedom) * math.tan(np.interp(level, area / area[-1], angle))


def highest(function, low, high):
    """Where a function with one maximum is highest, by golden-section search, and its value there."""
    golden = (math.sqrt(5) - 1) / 2
    a, b = high - golden * (high - low), low + golden * (high - low)
    at_a, at_b = function(a), function(b)
    for _ in range(45):
        if at_a >= at_b:
            high, b, at_b = b, a, at_a
            a = high - golden * (high - low)
            at_a = function(a)
        else:
            low, a, at_a = a, b, at_b
            b = low + golden * (high - low)
            at_b = function(b)
    return a, at_a


def likelihood_interval(profile, low, high, drop):
    """The most likely value, and where the profile of ln L is `drop` lower; infinite if that is not in low to high."""
    best, most = highest(profile, low, high)
    ends = []
    for outside, unbounded in ((low, -math.inf), (high, math.inf)):
        inside = best
        if profile(outside) > most - drop:
            inside = outside = unbounded
        while abs(outside - inside) > 1e-12 * (high - low):
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if profile(middle) > most - drop else (inside, middle)
        ends.append(inside)
    return best, *ends


def log_tail(z):
    """ln of the probability that a normal number exceeds z."""
    return math.log(math.erfc(z / math.sqrt(2)) / 2) if z < 25 else -z * z / 2 - math.log(z * math.sqrt(2 * math.pi))


def normal(z, above):
    """ln L of values at z = (value - mean) / sigma, less ln sigma for each that is observed."""
    return sum(map(log_tail, z[above])) - (z[~above] ** 2).sum() / 2


def gumbel(z, above):
    """The same for Gumbel's distribution of smallest values."""
    z = z - np.euler_gamma
    return z[~above].sum() - np.exp(z).sum()


def most_likely(distribution, residuals, above):
    """The most likely ln sigma, and ln L there."""
    scale = math.log((residuals**2).mean()) / 2
    likelihood = lambda log_sigma: distribution(residuals / math.exp(log_sigma), above) - (~above).sum() * log_sigma
    return highest(likelihood, scale - 12, scale + 5)


def mean_of(values, above, t, distribution):
    """The mean and its interval; `above`: whether the true value is larger."""
    n, mean, sigma = len(values), values.mean(), values.std()
    if not above.any():  # Student's interval
        half = t * sigma / math.sqrt(n - 1)
        return mean, mean - half, mean + half
    profile = lambda mean: most_likely(distribution, values - mean, above)[1]
    drop = n / 2 * math.log1p(t * t / (n - 1))
    return likelihood_interval(profile, mean - 1000 * sigma, mean + 1000 * sigma, drop)


def one_mean(values, above, level):
    """The mean and the union of its normal interval and Gumbel's; with one observed value a bound by the sign test."""
    n = len(values)
    if (~above).sum() < 2:
        return math.inf, values.min() if 0.5**n <= (1 - level) / 2 else -math.inf, math.inf
    t = t_quantile(n - 1, level)
    (mean, *ends), (_, *skewed) = (mean_of(values, above, t, distribution) for distribution in (normal, gumbel))
    return mean, min(ends[0], skewed[0]), max(ends[1], skewed[1])


def difference(a, b, paired, level):
    """mean(a) - mean(b) and the interval of Zou and Donner, from the normal intervals of both. The errors of pairs have
    the correlation of the residuals, of which a censored one is replaced by its expectation."""
    errors, residuals = [], []
    for values, above in (a, b):
        z = values - mean_of(values, above, 0, normal)[0]
        sigma = math.exp(most_likely(normal, z, above)[0]) if above.any() else values.std()
        z = z / sigma
        z[above] = [math.exp(-x * x / 2 - log_tail(x)) / math.sqrt(2 * math.pi) for x in z[above]]
        errors.append(sigma**2 / (len(values) - 1))
        residuals.append(z)
    n, m = len(a[0]) - 1, len(b[0]) - 1
    freedom = n if paired else sum(errors) ** 2 / (errors[0] ** 2 / n + errors[1] ** 2 / m)
    rho = np.corrcoef(*residuals)[0, 1] if paired else 0
    t = t_quantile(freedom, level)
    (x, x_low, x_high), (y, y_low, y_high) = (mean_of(*group, t, normal) for group in (a, b))
    joined = lambda p, q: math.sqrt(max(0, p * p + q * q - 2 * rho * p * q)) if p + q < math.inf else math.inf
    return x - y, x - y - joined(x - x_low, y_high - y), x - y + joined(x_high - x, y - y_low)


def slope(values, above, x, level):
    """The slope of values against x, with one sigma for all."""
    n, x = len(values), x - x.mean()

    def profile(b):
        residuals = values - b * x
        middle, reach = residuals.mean(), 5 * np.ptp(residuals)
        return highest(lambda a: most_likely(normal, residuals - a, above)[1], middle - reach, middle + reach)[1]

    drop = n / 2 * math.log1p(t_quantile(n - 2, level) ** 2 / (n - 2))
    widest = 1000 * values.std() / x.std()
    return likelihood_interval(profile, -widest, widest, drop)


def number_of(row):
    """The number of a run, and whether the true one is larger; nothing if it has none."""
    text = row["value"] or row.get("above")
    return (float(text), not row["value"]) if text else None


def by_packing(rows, function=float):
    """Of each packing the mean of a function of the numbers of its runs, and the share of runs that is censored.
    Numbers without a finite function are left out."""
    packings = {}
    for row in rows:
        if (number := number_of(row)) and math.isfinite(value := function(number[0])):
            packings.setdefault(row["packing"], []).append((value, number[1]))
    return {packing: np.mean(runs, axis=0) for packing, runs in packings.items()}


def columns(numbers):
    """Values, and whether they are censored."""
    values, above = np.array(list(numbers)).T
    return values, above > 0


def estimate(claim, rows):
    """A mean, or the difference of two, and its interval."""
    groups = [[row for row in rows if row["group"] == name] for name in dict.fromkeys(row["group"] for row in rows)]
    relative = "relative difference" in claim["quantity"]
    if len(groups) == 1:
        published = re.search(r"(?: less| minus|relative difference from) (\S+)$", claim["quantity"])
        off = float(published[1]) if published else 0
        away = lambda value: (value - off) / (abs(off) if relative else 1)
        return one_mean(*columns(by_packing(rows, away).values()), claim["level"])
    a, b = (by_packing(group, np.log if relative else float) for group in groups)  # relative: of logarithms
    most = max(len({row["packing"] for row in group}) for group in groups)
    paired = 4 * len(a.keys() & b.keys()) >= 3 * most  # otherwise Welch's test of all runs
    if paired:
        a, b = ({packing: group[packing] for packing in a if packing in b} for group in (a, b))
    found = difference(columns(a.values()), columns(b.values()), paired, claim["level"])
    return np.expm1(found) if relative else found


def bootstrap(statistic, parts, level):
    """The statistic of all parts, and Hesterberg's expanded interval of their bootstrap."""
    count = len(parts)
    tail = (1 - math.erf(t_quantile(count - 1, level) * math.sqrt(count / (count - 1)) / math.sqrt(2))) / 2
    random = np.random.default_rng(1)
    drawn = sorted(statistic(np.array(parts)[random.integers(0, count, count)]) for _ in range(4000))
    return statistic(np.array(parts)), drawn[round(tail * 3999)], drawn[round((1 - tail) * 3999)]


def quantile(density, probability):
    """Of a distribution of positive numbers, by integrating its density."""
    x = np.linspace(0, 200, 4_000_001)[1:]
    area = np.cumsum(density(x))
    return x[np.searchsorted(area / area[-1], probability)]


def spread_between(rows, level):
    """The standard deviation between the means of variants by analysis of variance, 0, and its upper limit: with F of
    the data divided by the quantile of F's distribution, and the quantile of chi-squared, at (1 - level) / 2."""
    groups = {}
    for row in rows:
        groups.setdefault(row["group"], []).append(row)
    groups = [columns(means.values())[0] for means in map(by_packing, groups.values()) if means]
    sizes = np.array([len(group) for group in groups])
    k, n = len(groups), sizes.sum()
    size = (n - (sizes**2).sum() / n) / (k - 1)
    means = np.array([group.mean() for group in groups])
    between = (sizes * (means - (sizes * means).sum() / n) ** 2).sum() / (k - 1)
    noise = sum(((group - group.mean()) ** 2).sum() for group in groups) / (n - k)
    a, b = (k - 1) / 2, (n - k) / 2
    f = quantile(lambda x: np.exp((a - 1) * np.log(x) - (a + b) * np.log1p(a / b * x)), (1 - level) / 2)
    chi = quantile(lambda x: np.exp((a - 1) * np.log(x) - x / 2), (1 - level) / 2)
    root = lambda variance: math.sqrt(max(0, variance) / size)
    return root(between - noise), 0, root((between - f * noise) * (k - 1) / chi)


def pooled_strata(rows):
    """The rows of both sides of each stratum in which both sides have a mean."""
    strata = {}
    for row in rows:
        strata.setdefault(row["stratum"], {"1": [], "2": []})[row["side"]].append(row)
    for sides in map(lambda stratum: list(stratum.values()), strata.values()):
        groups = [list(by_packing(side).values()) for side in sides]
        if min(map(len, groups)) >= 3 and all(sum(above == 0 for _, above in group) >= 2 for group in groups):
            yield sides


def pooled_difference(rows, level):
    """The difference of the means of two sides within strata, weighted by n m / (n + m); Welch's degrees of freedom."""
    weights = total = variance = fourth = 0
    for sides in pooled_strata(rows):
        groups = [list(by_packing(side).values()) for side in sides]
        weight = len(groups[0]) * len(groups[1]) / (len(groups[0]) + len(groups[1]))
        weights += weight
        for group, sign in zip(groups, (1, -1)):
            values, above = columns(group)
            n, t = len(values), t_quantile(len(values) - 1, level)
            if above.any():
                mean, low, high = one_mean(values, above, level)
                error = (high - low) / (2 * t)
            else:
                mean, error = values.mean(), values.std() / math.sqrt(n - 1)
            total += sign * weight * mean
            variance += (weight * error) ** 2
            fourth += (weight * error) ** 4 / (n - 1)
    half = t_quantile(variance**2 / fourth, level) * math.sqrt(variance) / weights
    return total / weights, total / weights - half, total / weights + half


def spread_ratio(rows, level):
    """The ratio of the standard deviations of two numbers of the same runs, about the means of variants, less 1, and
    the interval of Pitman and Morgan."""
    groups = {}
    for row in rows:
        if row["value"] and row["other"]:
            groups.setdefault(row["group"], []).append((float(row["value"]), float(row["other"])))
    x, y = np.concatenate([np.array(group) - np.mean(group, axis=0) for group in groups.values()]).T
    freedom = len(x) - len(groups) - 1
    k = 1 + 2 * (1 - (x @ y) ** 2 / (x @ x) / (y @ y)) * t_quantile(freedom, level) ** 2 / freedom
    ends = (1, k - math.sqrt(k * k - 1), k + math.sqrt(k * k - 1))
    return [math.sqrt(x @ x / (y @ y) * end) - 1 for end in ends]


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
        larger = int(row["grew"]) + int(row["absorbed"])
        smaller = int(row["shrank"]) + int(row["vanished"])
        table[int(row["size"]) - 1] += [larger + smaller, larger - smaller]
    return [list(group.values()) for group in groups.values()]


def ratio(a, b):
    """a / b of two estimates with their intervals, by Zou and Donner."""
    down = math.hypot(math.log(a[0] / a[1]), math.log(b[2] / b[0]))
    up = math.hypot(math.log(a[2] / a[0]), math.log(b[0] / b[1]))
    return a[0] / b[0], a[0] / b[0] * math.exp(-down), a[0] / b[0] * math.exp(up)


def most_likely_rate(events, offset, terms):
    """The terms c of ln(rate) = offset + terms c that are most likely if events are a Poisson process, and ln L."""
    prior = np.array([0, 1 / 9, 4])
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
    return c, value(c)


def predicted_onsets(rows):
    """phi at the onset in the two largest cells, if the rate per grain that is fitted to the two smallest ones holds
    there: the mean over steps of phi in which runs without an onset spend as many cycles as they do on average."""
    sizes = sorted({float(row["grains"]) for row in rows})
    terms_at = lambda phi: np.array([1, (phi - 0.646) / 0.002, ((phi - 0.646) / 0.002) ** 2])
    few = [row for row in rows if float(row["grains"]) <= sizes[1]]
    c, _ = most_likely_rate(np.array([int(row["onsets"]) for row in few]),
                            np.log([float(row["grain_cycles"]) for row in few]),
                            np.array([terms_at(float(row["phi"])) for row in few]))
    width, steps = 0.0005, {}
    for row in rows:
        steps.setdefault(math.floor(float(row["phi"]) / width), []).append((float(row["cycles"]), int(row["onsets"])))
    for size in sizes[2:]:
        own = [row for row in rows if float(row["grains"]) == size]
        grains = sum(float(row["grain_cycles"]) for row in own) / sum(float(row["cycles"]) for row in own)
        waiting, mean = 1, 0
        for step, passed in sorted(steps.items()):
            phi = (step + 0.5) * width
            cycles = np.mean([cycles for cycles, onsets in passed if onsets == 0] or [cycles for cycles, _ in passed])
            share = waiting * -math.expm1(-math.exp(terms_at(phi) @ c) * grains * cycles)
            mean, waiting = mean + share * phi, waiting - share
        yield size, mean + waiting * phi


def check_predictions(results, faults):
    """The points and the claims S5b.predicted_N that system_size.yaml states."""
    text = (results.parent / "system_size.yaml").read_text()
    stated = {float(size): float(phi) for size, phi in re.findall(r"\[(\d+), (0\.\d+), 0\.\d+\]", text)}
    found = dict(predicted_onsets(list(csv.DictReader((results / "nucleation/nucleation.verdict.csv").open()))))
    claimed = dict(re.findall(r"predicted_(\d+)\n(?:.*\n){4}.*value: (0\.\d+)", text))
    if {float(size): float(phi) for size, phi in claimed.items()} != stated:
        faults.append(f"system_size.yaml: predicted onsets {stated}, claims {claimed}")
    if stated.keys() != found.keys() or any(abs(stated[size] - found[size]) > 1e-5 for size in found):
        faults.append(f"system_size.yaml: predicted onsets {stated}, computed {found}")


def nucleation(rows, level):
    """The exponent of rate = c(amplitude, phi) n^a, and its interval. If runs share packings, the drop of ln L that the
    interval allows is multiplied by the variance of the score between packings over its variance between runs."""
    amplitudes = {}
    for row in rows:
        cycles, grains = float(row["cycles"]), float(row["grain_cycles"])
        u = (float(row["phi"]) - 0.646) / 0.002
        amplitudes.setdefault(row["amplitude_rad"], []).append(
            (math.log(cycles), math.log(grains / cycles), int(row["onsets"]), 1, u, u * u, row["packing"]))

    def logarithm(exponent):
        total = 0
        for shares in amplitudes.values():
            cycles, size, events, *terms = np.array([share[:-1] for share in shares]).T
            if events.sum() == 0:
                continue
            terms = np.array(terms).T
            total += most_likely_rate(events, cycles + exponent * size, terms)[1]
        return total

    def factor(exponent):
        scores, information = {}, 0
        for shares in amplitudes.values():
            cycles, size, events, *terms = np.array([share[:-1] for share in shares]).T
            if events.sum() == 0:
                continue
            terms = np.array(terms).T
            c, _ = most_likely_rate(events, cycles + exponent * size, terms)
            expected = np.exp(cycles + exponent * size + terms @ c)
            curvature = (terms.T * expected) @ terms + np.diag([0, 1 / 9, 4])
            off = size - terms @ np.linalg.solve(curvature, terms.T @ (expected * size))
            information += (expected * off * size).sum()
            for share, score in zip(shares, (events - expected) * off):
                scores[share[-1]] = scores.get(share[-1], 0) + score
        return max(1, sum(score**2 for score in scores.values()) / information)

    drop = NormalDist().inv_cdf((1 + level) / 2) ** 2 / 2
    if len({row["packing"] for row in rows}) < len({(row["group"], row["seed"]) for row in rows}):
        drop *= factor(highest(logarithm, -30, 30)[0])
    return likelihood_interval(logarithm, -30, 30, drop)


def expected(claim, rows):
    """Estimate and interval, and what share of the interval they may differ by; None for a claim of another kind."""
    level = claim["level"]
    filled = {column for row in rows for column, text in row.items() if text}  # of this claim
    if "place" in filled:
        packings = {}
        for row in rows:
            packings.setdefault(row["packing"], []).append(float(row["value"]))
        return bootstrap(share, [(sum(values), len(values)) for values in packings.values()], level), 0.1
    if "vanished" in filled:
        sizes = [bootstrap(critical_size, group, level) for group in growth_counts(rows)]
        if len(sizes) == 2:
            return np.subtract(ratio(sizes[1], sizes[0]), 1), 0.1
        published = float(re.search(r"from (\d+)", claim["quantity"])[1])
        again = re.search(r"would give ([\d.]+) to ([\d.]+)", claim["note"])
        if not again:
            return None
        least, most = (sizes[0][0] / float(end) for end in again.groups())
        return np.subtract(ratio(sizes[0], (published, published * most, published * least)), 1), 0.1
    if "grain_cycles" in filled:
        return np.subtract(nucleation(rows, level), 1), 1e-4
    if "stratum" in filled:
        return pooled_difference(rows, level), 1e-4
    if "other" in filled:
        return spread_ratio(rows, level), 1e-4
    if "standard deviation between variants" in claim["quantity"]:
        return spread_between(rows, level), 1e-3
    if "x" in filled:
        numbers = [(*number, float(row["x"])) for row in rows if (number := number_of(row))]
        values, above, x = np.array(numbers).T
        return slope(values, above > 0, x, level), 1e-4
    if "value" in filled or "above" in filled:
        return estimate(claim, rows), 1e-4
    return None


def ruling(claim, interval, seeds):
    low, high = interval
    margin = claim["margin"]
    if claim["verdict"] == "cannot be decided":  # for the reason that the note states
        return claim["verdict"]
    if low == high == 0 and "agree in every digit" in claim["note"]:
        return "undecided"
    if claim.get("looks") and seeds > claim["look"]:  # between two looks there is no verdict
        return "undecided"
    if claim["verdict"] in ("supported", "refuted"):  # of a direction, which may be either
        return claim["verdict"] if low > margin or high < margin else "undecided"
    if -margin <= low and high <= margin:
        return "agrees"
    return "differs" if high < -margin or low > margin else "undecided"


# Newton's method takes steps back, z may have a far too small sigma, and numbers without a logarithm are left out.
@np.errstate(over="ignore", divide="ignore", invalid="ignore")
def main():
    checked, faults, largest = 0, [], {}
    for path in sorted(pathlib.Path(sys.argv[1]).glob("**/*.verdict.csv")):
        if path.parent.name == "cost":  # times, and differences of 1e-16
            continue
        entered = list(csv.DictReader(path.open()))
        for claim in json.loads(path.with_suffix(".json").read_text())["claims"]:
            key = "id" if entered and "id" in entered[0] else "claim"  # older files have no column `id`
            rows = [row for row in entered if row[key] == claim[key]]
            if claim["interval"] is None:
                continue
            again = expected(claim, rows) if rows and "log2" not in claim["quantity"] else None
            if again is None:
                if claim.get("primary"):
                    faults.append(f"{path}: {claim['claim']}: not recomputed")
                continue
            checked += 1
            numbers, allowed = again
            published = np.array([claim["estimate"], *claim["interval"]], float)
            published = np.where(np.isnan(published), [np.inf, -np.inf, np.inf], published)  # null: infinite
            finite = published[np.isfinite(published)]
            length = np.ptp(finite) or abs(finite[0]) if finite.size else 1
            rounding = 5e-6 * np.abs(published)
            differences = [0 if a == b else abs(a - b) - r for a, b, r in zip(published, numbers, rounding)]
            away = np.max(np.maximum(0, differences)) / length  # NaN stays
            largest[allowed] = max(away, largest.get(allowed, 0))
            if not away <= allowed:
                found, stated = ("{:.6g}, {:.6g} to {:.6g}".format(*three) for three in (numbers, published))
                faults.append(f"{path}: {claim['claim']}: {found}, published {stated}")
            used = [row for sides in pooled_strata(rows) for side in sides for row in side] if rows[0].get("stratum") else rows
            if sum(bool(row.get("above")) for row in used) != claim.get("censored", 0):
                faults.append(f"{path}: {claim['claim']}: censored rows and their published number differ")
            if ruling(claim, published[1:], len({row["seed"] for row in rows})) != claim["verdict"]:
                faults.append(f"{path}: {claim['claim']}: {claim['verdict']} does not follow from the interval")
    check_predictions(pathlib.Path(sys.argv[1]), faults)
    print(f"{checked} verdicts recomputed")
    for allowed, away in largest.items():
        print(f"largest difference {away:.2g} of the interval, where {allowed:g} is allowed")
    sys.exit("\n".join(faults) if faults or checked == 0 else 0)


main()
