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


def curve(motion, method):
    return [row for row in errors if (row["motion"], row["method"]) == (motion, method)]


table("errors", ["motion: error", "method", "at 0.36", "order"],
      ([title, method, number(rows[2]["relative_error"]), f"{float(rows[2]['fitted_order']):.2f}"]
       for motion, title in MOTIONS.items() for method in METHODS for rows in [curve(motion, method)]))

table("costs", ["time step [s]", "of the limit"] +
      [f"{method}: error; core-seconds" for method in (*METHODS, "LAMMPS")],
      ([number(rows[0]["time_step_s"], 3), f"{float(rows[0]['time_step_over_stability_limit']):.2f}"] +
       [f"{number(row['relative_error'])}; {number(row['core_seconds_per_cycle'])}" for row in rows]
       for rows in zip(*(curve("collision", method)[::2] for method in (*METHODS, "LAMMPS")))))

energy = read("accuracy/accuracy-energy.csv")
by_step = zip(*([row for row in energy if row["method"] == method] for method in METHODS))
table("energy", ["time step [s]", "of the limit"] + [f"{method}: energy (local order)" for method in METHODS],
      ([number(rows[0]["time_step_s"], 3), f"{float(rows[0]['time_step_over_stability_limit']):.2f}"] +
       [f"{float(row['mean_energy_change']):+.1e} ({float(row['local_order']):.1f})" for row in rows]
       for rows in by_step))

table("divergence", ["time step [s]", "of the limit", "Lyapunov time [ms]"],
      ([number(row["time_step_s"], 3), f"{float(row['time_step_over_stability_limit']):.2f}",
        f"{1e3 * float(row['lyapunov_time_s']):.2f} +- {1e3 * float(row['standard_error_s']):.2f}"]
       for row in read("accuracy/accuracy-divergence.csv")))

stiffness = read("decide/spring_constant/S1.csv")
hardest = stiffness[-1]
table("stiffness", ["k", "cost", "mean overlap [d]", "bias of phi_u", "bias of phi, Eq. (S4)"],
      ([f"{factor:.3g} k_0", f"{factor ** 0.5:.2g}", number(row["overlap_mean_d"], 3),
        f"{float(row['phi_u_mean']) - float(hardest['phi_mean']):+.4f}",
        f"{float(row['phi_mean']) - float(hardest['phi_mean']):+.4f}"]
       for row in stiffness for factor in [10 ** float(row["log10_k_over_k0"])] if float(row["log10_k_over_k0"]) in (0, 0.5, 1)))
