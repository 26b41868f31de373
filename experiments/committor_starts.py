#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Chooses the states in which the clones of committor.yaml begin, from the runs of committor_parents.yaml:

    shearcell table --experiment committor_parents --scale paper | python3 experiments/committor_starts.py

prints the sweep of that scale. The rule, fixed before any clone was computed: a state of a run belongs to the bin of its
largest crystallite (0 to 2 grains: a control). A run gives to each bin the first such state from cycle `first` on, and a
control from twice that cycle on, before the run has a crystallite of 60 grains. Bin k takes the runs in the order of
their seeds, from the one at place 5 k on, in turn, until it has as many states as stated here.
"""
import collections
import csv
import sys

BINS = [(0, 2), (3, 4), (5, 7), (8, 12), (13, 20)]  # controls, then followed_bins of analysis/committor.hpp
# first: about half of the median of the onset at N = 7900. cycles of a clone: crystallites of 3 to 20 grains take about
# half of them to grow, and K = 3 cycles without a descendant fit twice. states of a bin, and controls: four clones of
# all states of an amplitude take 1.6e11 particle-steps; at A = 0.05, a pilot, 1.0e11.
Design = collections.namedtuple("Design", "first cycles states controls")
PAPER = {"0.05": Design(28, 25, 2, 2), "0.0667": Design(14, 14, 6, 5), "0.0833": Design(7, 9, 9, 6),
         "0.1": Design(5, 7, 12, 8)}
DESK = {"0.1": Design(5, 7, 4, 4)}


def chosen(runs, design):
    """(seed, cycle) of each state, by bin; `runs`: the largest crystallite by cycle, by seed."""
    for k, (low, high) in enumerate(BINS):
        seeds = sorted(runs)
        place = 5 * k % len(seeds)
        found = []
        for seed in seeds[place:] + seeds[:place]:
            for cycle, largest in sorted(runs[seed].items()):
                if largest >= 60:
                    break
                if cycle >= design.first * (1 if k else 2) and low <= largest <= high:
                    found.append((seed, cycle))
                    break
        yield from found[: design.states if k else design.controls]


def main():
    runs = collections.defaultdict(lambda: collections.defaultdict(dict))
    scales = set()
    for row in csv.DictReader(sys.stdin):
        runs[row["amplitude_rad"]][int(row["seed"])][int(row["cycle"])] = int(row["largest_crystallite"] or 0)
        scales.add(row["scale"])
    (scale,) = scales
    columns = {"amplitude_rad": [], "cycles": [], "start_seed": [], "start_cycle": []}
    for amplitude in sorted(runs, key=float):
        design = (DESK if scale == "desk" else PAPER)[amplitude]
        for seed, cycle in chosen(runs[amplitude], design):
            for column, value in zip(columns.values(), (amplitude, design.cycles, seed, cycle)):
                column.append(str(value))
    print(f"  {scale}:\n    sweep:\n      zip:")
    for name, values in columns.items():
        line = f"        {name}: ["
        for value in values:
            if len(line) + len(value) > 116:
                print(line.rstrip())
                line = " " * 12
            line += value + ", "
        print(line[:-2] + "]")


main()
