#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture at the top of README.md: a packing that crystallizes under shear, cut open.

    PYTHONPATH=experiments/python python3 experiments/results/grains.py experiments/results/grains.svg [STORE]

Computes the run if STORE (default: shearcell-store-grains) lacks it, a minute on one core, and writes an SVG file. The same state
gives the same bytes. Needs the program shearcell, numpy and h5py.
"""
import csv
import io
import sys

import numpy as np

import shearcell

MANIFEST = {
    "experiment": "grains",
    "question": "What does crystallization look like?",
    "base": {"grains": 5200, "walls": "rough", "amplitude_rad": 0.1, "steps_per_cycle": 24000, "cycles": 40},
    "checkpoints": {"phases": [0.25]},
}
CYCLES = (0, 18, 20.25, 40)
CUT = 8.4  # z of the plane nearest to the viewer [d]: it goes through the first nucleus. The cell is periodic in z.
SCALE = 18  # pixels per d
LAYERS = 4  # shades: grains more than one d behind the front are darker, and so on
KINDS = {  # by the stored measure `structure`; wall grains are drawn as a fourth kind
    0: ("disordered", (216, 211, 201)),
    1: ("FCC", (24, 112, 188)),
    2: ("HCP", (230, 106, 28)),
    3: ("wall grains", (118, 124, 136)),
}
INK = (38, 42, 52)


def mix(colour, other, share):
    return tuple(round(a + (b - a) * share) for a, b in zip(colour, other))


def hexadecimal(colour):
    return "#%02x%02x%02x" % colour


def shaded_discs():
    """A disc for each kind of grain and each layer, lit from the upper left."""
    for kind, (_, colour) in KINDS.items():
        for layer in range(LAYERS):
            body = mix(colour, INK, 0.2 * layer)
            light, edge = mix(body, (255, 255, 255), 0.6 - 0.12 * layer), mix(body, (15, 15, 25), 0.42)
            yield (f'<radialGradient id="r{kind}{layer}" cx=".36" cy=".32" r=".72">'
                   f'<stop offset="0" stop-color="{hexadecimal(light)}"/>'
                   f'<stop offset=".42" stop-color="{hexadecimal(body)}"/>'
                   f'<stop offset="1" stop-color="{hexadecimal(edge)}"/></radialGradient>'
                   f'<circle id="g{kind}{layer}" r="{SCALE / 2:g}" fill="url(#r{kind}{layer})"/>')


def visible(position):
    """The spheres that are not wholly hidden behind later ones, by painting them in order into an array of numbers."""
    fine = 24  # cells per d
    y, x = np.mgrid[-fine // 2:fine // 2 + 1, -fine // 2:fine // 2 + 1]
    disc = x**2 + y**2 <= (fine / 2) ** 2
    corner = position.min(axis=0) - 1
    at = np.rint((position - corner) * fine).astype(int)
    canvas = np.full(at.max(axis=0) + fine, -1)
    for number, (column, line) in enumerate(at):
        canvas[column + x[disc], line + y[disc]] = number
    seen, count = np.unique(canvas[canvas >= 0], return_counts=True)
    return seen[count >= 5]


def panel(state, left, top):
    """The grains of a checkpoint from back to front, and the edges of its cell; `left`, `top`: of the top wall [pixels]."""
    depth, height, floor = state.cell[2, 2], state.cell[1, 1], state.origin[1]
    walls = state.wall_position[state.wall_position[:, 1] > floor - 0.5]  # the side walls go on below the moving wall
    position = np.concatenate([state.position, walls])
    kind = np.concatenate([state.structure, np.full(len(walls), 3)]).astype(int)
    behind = depth - (position[:, 2] - CUT) % depth  # of the cut [d]
    order = np.argsort(-behind, kind="stable")
    position, kind, behind = position[order], kind[order], behind[order]
    layer = np.minimum(behind, LAYERS - 1).astype(int)
    x = left + SCALE * position[:, 0]
    y = top + SCALE * (floor + height - position[:, 1])
    for i in visible(position[:, :2]):
        yield f'<use href="#g{kind[i]}{layer[i]}" x="{x[i]:.0f}" y="{y[i]:.0f}"/>'
    width, shift = state.cell[0, 0], state.cell[1, 0]
    corners = " ".join(f"{left + SCALE * a:.1f},{top + SCALE * b:.1f}"
                       for a, b in ((0, 0), (width, 0), (width - shift, height), (-shift, height)))
    yield f'<polygon points="{corners}" fill="none" stroke="{hexadecimal(INK)}" stroke-width="1.5"/>'


def text(x, y, words, size=17, weight="normal", anchor="middle"):
    return (f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}" font-size="{size}" '
            f'font-weight="{weight}">{words}</text>')


def main():
    store = shearcell.run(MANIFEST, store=sys.argv[2] if len(sys.argv) > 2 else "shearcell-store-grains")
    run = store.runs(experiment="grains")[0]
    rows = csv.DictReader(io.StringIO(store.call("table", "--experiment", "grains", "--out", "-")))
    percent = {float(row["cycle"]): float(row["crystalline_percent"]) for row in rows}
    drawn, left, top, bottom = [], 30.0, 76.0, 0.0
    for cycle in CYCLES:
        state = run.checkpoint(cycle)
        width, height, shift = SCALE * state.cell[0, 0], SCALE * state.cell[1, 1], SCALE * state.cell[1, 0]
        left += shift
        drawn += panel(state, left, top)
        middle = left + width / 2
        drawn += [text(middle, 32, f"cycle {cycle:g}", 19, "bold"),
                  text(middle, 54, f"{percent[cycle]:.0f} % crystalline" if cycle else "settled")]
        left += width + 44
        bottom = max(bottom, top + height)
    total, x = left - 14, 30
    for kind, (name, _) in KINDS.items():
        drawn += [f'<use href="#g{kind}0" x="{x + SCALE / 2:.0f}" y="{bottom + 36:.0f}"/>',
                  text(x + SCALE + 8, bottom + 42, name, anchor="start")]
        x += SCALE + 40 + 9 * len(name)
    size = f"{total:.0f} {bottom + 60:.0f}"
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size}" '
                   f'font-family="sans-serif" fill="{hexadecimal(INK)}">\n'
                   '<rect width="100%" height="100%" rx="14" fill="#ffffff"/>\n<defs>\n')
        file.write("\n".join([*shaded_discs(), "</defs>", *drawn, "</svg>"]) + "\n")


main()
