# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a packing of 500 spheres in every format that can be read: write_packings.py FOLDER
By plain text, by ASE and by LAMMPS; those that are not installed are left out. Lengths in units of the diameter;
truth.csv has all digits."""
import pathlib
import random
import shutil
import subprocess
import sys

folder = pathlib.Path(sys.argv[1])
random.seed(5)
# Spheres on a lattice, moved a little so that no two touch, in a box of 10 x 12 x 11.
sites = [(i, j, k) for i in range(8) for j in range(9) for k in range(8)][:500]
place = [[0.7 + 1.22 * n + random.uniform(-0.1, 0.1) for n in site] for site in sites]
speed = [[random.gauss(0, 1) for _ in range(3)] for _ in sites]
box = (10.0, 12.0, 11.0)


def write(name, head, rows):
    (folder / name).write_text("\n".join([head, *(" ".join(map(str, row)) for row in rows)]) + "\n")


def table(name, head, separator):
    rows = (separator.join(f"{number:.17g}" for number in [*p, *v]) for p, v in zip(place, speed))
    (folder / name).write_text("\n".join([head, *rows]) + "\n")


table("truth.csv", "x_d,y_d,z_d,vx_d_per_s,vy_d_per_s,vz_d_per_s", ",")
table("script.csv", "x;y;z;vx;vy;vz", ";")
write("plain.xyz", "500\nspheres", [["A", *p] for p in place])
write("script.extxyz", f'500\nLattice="{box[0]} 0 0 0 {box[1]} 0 0 0 {box[2]}" pbc="F F T" Properties=species:S:1:pos:R:3:'
      "vel:R:3:radius:R:1", [["A", *p, *v, 0.5] for p, v in zip(place, speed)])
bounds = "".join(f"0 {length} {axis}lo {axis}hi\n" for length, axis in zip(box, "xyz"))
head = f"made by a script\n\n500 atoms\n1 atom types\n{bounds}\nAtoms # sphere\n"
rows = [[i + 1, 1, 1, 1.9, *p] for i, p in enumerate(place)]
velocities = "\n".join(" ".join(map(str, [i + 1, *v, 0, 0, 0])) for i, v in enumerate(speed))
write("script.data", head, [*rows, ["\nVelocities\n\n" + velocities]])

try:
    import ase
    import ase.io
    import numpy
    atoms = ase.Atoms(numbers=[1] * 500, positions=place, cell=box, pbc=(False, False, True))
    ase.io.write(folder / "ase_still.xyz", atoms)
    atoms.set_array("velo", numpy.array(speed))
    ase.io.write(folder / "ase.xyz", atoms)
    ase.io.write(folder / "ase_still.data", atoms, format="lammps-data")
    del atoms.arrays["velo"]
    atoms.set_array("forces", numpy.array(speed))
    atoms.set_array("radius", numpy.full(500, 0.5))
    atoms.info = {"energy": -1.5, "note": "a = b, c", "stress": numpy.zeros(6)}
    ase.io.write(folder / "ase_columns_still.xyz", atoms, columns=["forces", "symbols", "positions", "radius"])
except ImportError:
    print("without ASE (Debian package python3-ase)")

try:
    import MDAnalysis
    universe = MDAnalysis.Universe.empty(500, trajectory=True)
    universe.add_TopologyAttr("name", ["A"] * 500)
    universe.atoms.positions = place
    universe.atoms.write(str(folder / "mdanalysis_still.xyz"))
except ImportError:
    print("without MDAnalysis (Debian package python3-mdanalysis)")

lammps = shutil.which("lmp")
if lammps is None:
    print("without LAMMPS (Debian package lammps)")
    sys.exit()
deck = """units lj
atom_style {style}
boundary f f p
read_data {data}
pair_style zero 1.0
pair_coeff * *
mass * 1
dump custom all custom 1 {out}.dump id type x y z vx vy vz
dump_modify custom format float %.17g
dump more all custom 1 {out}_more.dump id type x y z xu yu zu ix iy iz vx vy vz fx
dump_modify more format float %.17g units yes time yes
dump xyz all xyz 1 {out}_still.xyz
run 0
write_data {out}.data
"""
for style, data, out in (("sphere", "script.data", "lammps_sphere"), ("hybrid sphere", "hybrid.data", "lammps_hybrid"),
                         ("atomic", "atomic.data", "lammps_atomic")):
    text = (folder / "script.data").read_text().splitlines()
    start = next(i for i, line in enumerate(text) if line.startswith("Atoms")) + 1
    text[start - 1] = f"Atoms # {style}"
    for i in range(start + 1, start + 501):
        ident, kind, size, density, x, y, z = text[i].split()
        text[i] = " ".join([ident, kind, x, y, z] + ([size, density] if "hybrid" in style else []))
    if style == "atomic":
        text = [" ".join(line.split()[:4]) if i > start + 502 else line for i, line in enumerate(text)]
    if style != "sphere":
        (folder / data).write_text("\n".join(text) + "\n")
    words = deck.format(style=style, data=data, out=out)
    if style != "atomic":
        words = words.replace("mass * 1\n", "")
    run = subprocess.run([lammps, "-log", "none", "-screen", "none"], input=words, text=True, cwd=folder)
    assert run.returncode == 0, f"LAMMPS failed with {style}"
