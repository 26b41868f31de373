# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the tables of core/ACCURACY.md from the files in experiments/results: python3 accuracy.py RESULTS_FOLDER"""

import csv
import pathlib
import sys

results = pathlib.Path(sys.argv[1])
MOTIONS = {"collision": "two grains collide: speed after it",
           "wall": "one grain swings on a wall, ten periods: position over amplitude",
           "wave": "fastest wave in a row of 8 grains: frequency"}
METHODS = ("engine", "PEFRL", "Runge-Kutta")


def read(name):
    with open(results / name, newline="") as file:
        return list(csv.DictReader(file))


def table(name, heading, rows):
    print(f"<!-- {name} -->\n| {' | '.join(heading)} |\n|{'---|' * len(heading)}")
    for row in rows:
        print(f"| {' | '.join(row)} |")
    print("<!-- end -->")


def number(text, digits=2):
    value = float(text)
    return f"{value:.0f}" if value >= 100 else f"{value:.{digits}g}".replace("e-0", "e-")


errors = read("accuracy/accuracy-order.csv")


def error_and_order(motion, method):
    at = [row for row in errors if (row["motion"], row["method"]) == (motion, method)][2]  # at Table I's time step
    return f"{number(at['relative_error'])} ({float(at['fitted_order']):.2f})"


table("errors", ["motion: error (order)", *METHODS],
      ([title, *(error_and_order(motion, method) for method in METHODS)] for motion, title in MOTIONS.items()))

stiffness = read("decide/spring_constant/S1.csv")
hardest = stiffness[-1]
table("stiffness", ["k", "cost", "mean overlap [d]", "bias of phi_u", "bias of phi, Eq. (S4)"],
      ([f"{factor:.3g} k_0", f"{factor ** 0.5:.2g}", number(row["overlap_mean_d"], 3),
        f"{float(row['phi_u_mean']) - float(hardest['phi_mean']):+.4f}",
        f"{float(row['phi_mean']) - float(hardest['phi_mean']):+.4f}"]
       for row in stiffness for factor in [10 ** float(row["log10_k_over_k0"])] if float(row["log10_k_over_k0"]) in (0, 0.5, 1)))
