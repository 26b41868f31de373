#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Chooses the states in which the clones of committor.yaml begin, from the runs of committor_parents.yaml:

    shearcell table --experiment committor_parents --scale paper | python3 experiments/committor_starts.py 8 8 paper

prints the sweep of that scale: at each amplitude at most 8 states for each bin of sizes, and 8 controls. The rule, fixed
before any clone was computed: a state of a run belongs to the bin of its largest crystallite (0 to 2 grains: a control).
A run gives to each bin the first such state from cycle FIRST on, before it has a crystallite of 60 grains. Bin k takes
the runs in the order of their seeds, from the one at place 5 k on, in turn.
"""
import collections
import csv
import sys

BINS = [(0, 2), (3, 4), (5, 7), (8, 12), (13, 20)]  # followed_bins of analysis/committor.hpp, after the controls
# Half of the median of the onset; and the cycles of a clone, in which K = 3 cycles without a descendant fit several
# times, since growth takes about half of the cycles to the onset.
FIRST = {"0.05": 28, "0.0667": 14, "0.0833": 7, "0.1": 5}
CLONE = {"0.05": 25, "0.0667": 14, "0.0833": 9, "0.1": 7}


def starts(rows, states, controls):
    """Yields (amplitude, seed, cycle), by amplitude, bin and seed."""
    runs = collections.defaultdict(list)
    for row in rows:
        runs[row["amplitude_rad"], int(row["seed"])].append((int(row["cycle"]), int(row["largest_crystallite"] or 0)))
    for amplitude in sorted({a for a, _ in runs}, key=float):
        seeds = sorted(seed for a, seed in runs if a == amplitude)
        for k, (low, high) in enumerate(BINS):
            place = 5 * k % len(seeds)
            found = []
            for seed in seeds[place:] + seeds[:place]:
                for cycle, largest in sorted(runs[amplitude, seed]):
                    if largest >= 60:
                        break
                    if cycle >= FIRST.get(amplitude, 0) and low <= largest <= high:
                        found.append((amplitude, seed, cycle))
                        break
            yield from found[: states if k else controls]


def main():
    states, controls, scale = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
    chosen = list(starts(csv.DictReader(sys.stdin), states, controls))
    columns = {
        "amplitude_rad": [a for a, _, _ in chosen],
        "cycles": [CLONE.get(a, 8) for a, _, _ in chosen],
        "start_seed": [s for _, s, _ in chosen],
        "start_cycle": [c for _, _, c in chosen],
    }
    print(f"  {scale}:\n    sweep:\n      zip:")
    for name, values in columns.items():
        print(f"        {name}: [{', '.join(map(str, values))}]")


main()
