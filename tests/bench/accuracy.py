# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the table of core/ACCURACY.md from accuracy-order.csv: python3 accuracy.py FOLDER"""

import csv
import pathlib
import sys

MOTIONS = {"collision": "two grains collide: speed after it",
           "wall": "one grain swings on a wall, ten periods: position over amplitude",
           "wave": "fastest wave in a row of 8 grains: frequency"}
METHODS = ("engine", "PEFRL", "Runge-Kutta")

with open(pathlib.Path(sys.argv[1]) / "accuracy-order.csv", newline="") as file:
    rows = list(csv.DictReader(file))


def error_and_order(motion, method):
    row = [row for row in rows if (row["motion"], row["method"]) == (motion, method)][2]  # at Table I's time step
    error = f"{float(row['relative_error']):.2g}".replace("e-0", "e-")
    return f"{error} ({float(row['fitted_order']):.2f})"


print("<!-- errors -->\n| motion: error (order) | " + " | ".join(METHODS) + " |\n" + "|---" * (1 + len(METHODS)) + "|")
for motion, title in MOTIONS.items():
    print(f"| {title} | " + " | ".join(error_and_order(motion, method) for method in METHODS) + " |")
print("<!-- end -->")
