#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads exported frames with the field's own readers and compares every number with truth.json.

    python3 read_back.py FOLDER

FOLDER holds run.h5md, run.xyz (in diameters), metres.xyz, vtk/, lammps/ and truth.json, a list of frames; also
texts.json, names and how they are read from extended XYZ, with a frame of texts.xyz and a file texts_N.h5md for each.
Readers: h5py and MDAnalysis for H5MD, ASE and MDAnalysis for extended XYZ, VTK, MDAnalysis for LAMMPS data.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import warnings

warnings.simplefilter("ignore")

import ase.io
import h5py
import MDAnalysis
import numpy as np
import vtk
from MDAnalysis.coordinates.H5MD import H5MDReader
from vtk.util.numpy_support import vtk_to_numpy

folder = pathlib.Path(sys.argv[1])
frames = json.loads((folder / "truth.json").read_text())
for frame in frames:
    for key, value in frame.items():
        if isinstance(value, list):
            frame[key] = np.array(value)
    # Unknown, as a mean over no grain; the formats that can leave it out do.
    frame["scalars"] = {name: value for name, value in frame["scalars"].items() if value is not None}
REAL = ["phi_local", "q6", "overlap", "grain_pressure_Pa", "displacement_d", "d2min_d2"]
INTEGER = ["contacts", "structure", "lattice", "crystallite"]
compared = 0


def equal(what, got, expected, tolerance=0.0):
    """Every number, to a relative tolerance of the largest."""
    global compared
    got, expected = np.asarray(got), np.asarray(expected)
    assert got.shape == expected.shape, f"{what}: shape {got.shape}, not {expected.shape}"
    scale = np.max(np.abs(expected)) if expected.size else 0
    worst = np.max(np.abs(got - expected)) if expected.size else 0
    assert worst <= tolerance * scale, f"{what}: differs by {worst:g} of {scale:g}"
    compared += got.size


def same(what, got, expected):
    """A text, or a number to the last digit."""
    global compared
    assert got == expected, f"{what}: {got!r}, not {expected!r}"
    compared += 1


def check_h5md():
    with h5py.File(folder / "run.h5md") as file:
        for key, value in frames[0]["facts"].items():
            got = file["parameters"].attrs[key]
            same("h5 " + key, got.decode() if isinstance(got, bytes) else got, value)
        group = file["particles/all"]
        assert list(file["h5md"].attrs["version"]) == [1, 1]
        assert [b.decode() for b in group["box"].attrs["boundary"]] == ["none", "none", "periodic"]
        for k, f in enumerate(frames):
            equal("h5 step", group["step"][k], f["step"])
            equal("h5 time", group["position/time"][k], f["time"])
            equal("h5 edges", group["box/edges/value"][k], f["edges"] * 1e9, 1e-15)
            equal("h5 origin", group["box/origin/value"][k], f["origin"] * 1e9, 1e-15)
            equal("h5 position", group["position/value"][k], f["position"] * 1e9, 1e-15)
            equal("h5 velocity", group["velocity/value"][k], f["velocity"])
            equal("h5 species", group["species"], f["type"])
            equal("h5 id", group["id"], f["id"])
            same("h5 checkpoint", file["observables/checkpoint/value"][k].decode(), f["checkpoint"])
            image = group["image/value"][k]
            assert not image[:, :2].any()
            equal("h5 image", image[:, 2], f["periods"])
            equal("h5 radius", group["radius"], f["radius"] * 1e9, 1e-15)
            for name in REAL + INTEGER:
                equal("h5 " + name, group[name + "/value"][k], f[name])
            for name, value in f["scalars"].items():
                equal("h5 " + name, file[f"observables/{name}/value"][k], value)
    reader = MDAnalysis.Universe(str(folder / "run.h5md")).trajectory  # as in RECIPES.md
    assert isinstance(reader, H5MDReader)
    assert reader.n_frames == len(frames)
    for f, step in zip(frames, reader):  # angstrom, picoseconds and float32 by MDAnalysis's choice
        equal("MDAnalysis position", step.positions, f["position"] * 1e10, 1e-6)
        equal("MDAnalysis velocity", step.velocities, f["velocity"] * 1e-2, 1e-6)
        lengths = np.linalg.norm(f["edges"], axis=1) * 1e10
        equal("MDAnalysis box", step.dimensions[:3], lengths, 1e-6)


def check_extxyz(name, unit):
    read = ase.io.read(folder / name, ":")
    assert len(read) == len(frames)
    for f, atoms in zip(frames, read):
        d = 2 * f["radius"][0]
        scale = d if unit == "d" else 1.0
        same("xyz d_m", atoms.info["d_m"], d)
        same("xyz unit", atoms.info["length_unit"], unit)
        equal("xyz cell", atoms.cell.array * scale, f["edges"], 1e-15)
        equal("xyz origin", atoms.info["Origin"] * scale, f["origin"], 1e-15)
        assert list(atoms.pbc) == [False, False, True]
        equal("xyz position", atoms.positions * scale, f["position"], 1e-15)
        equal("xyz velocity", atoms.arrays["velo"] * scale, f["velocity"], 1e-15)
        equal("xyz radius", atoms.arrays["radius"] * scale, f["radius"], 1e-15)
        for key, value in {**f["facts"], **f["scalars"], "checkpoint": f["checkpoint"]}.items():
            same("xyz " + key, atoms.info[key], value)
        equal("xyz time", atoms.info["Time"], f["time"])
        equal("xyz theta", atoms.info["theta"], f["theta"])
        equal("xyz symbols", atoms.numbers, np.where(f["type"] == 0, 1, 2))
        for column in REAL + INTEGER + ["id"]:
            equal("xyz " + column, atoms.arrays[column], f[column])
        equal("xyz wall_side", atoms.arrays["wall_side"], f["type"])
    universe = MDAnalysis.Universe(str(folder / name))
    assert len(universe.trajectory) == len(frames)
    equal("MDAnalysis xyz", universe.atoms.positions * scale, frames[0]["position"], 1e-6)


# OVITO's XYZImporter gives these columns one property, "Particle Type"; the last one overwrites the others.
OVITO_TYPE = {"type", "element", "atom_types", "species"}


def ovito_attributes(line):
    """The attributes of a comment line by the rules of OVITO's XYZImporter: double quotes; int, double, else text."""
    found = {}
    for key, quoted, plain in re.findall(r'([^=\s]+)=(?:"([^"]*)"|(\S*))', line):
        assert key not in found, f"two keys {key}"
        found[key] = quoted or plain
        for kind in (int, float):
            try:
                found[key] = kind(found[key])
                break
            except ValueError:
                pass
    return found


def check_texts():
    names = json.loads((folder / "texts.json").read_text())
    read = ase.io.read(folder / "texts.xyz", ":")
    lines = [line for line in (folder / "texts.xyz").read_text().splitlines() if line.startswith("Lattice=")]
    assert len(read) == len(lines) == len(names) > 20
    for k, ((name, as_text), atoms, line) in enumerate(zip(names.items(), read, lines)):
        ovito = ovito_attributes(line)
        columns = [column.lower() for column in ovito["Properties"].split(":")[::3]]
        same("OVITO types", len(OVITO_TYPE.intersection(columns)), 1)
        for info in (atoms.info, ovito):
            same("xyz experiment", info["experiment"], as_text)
            same("xyz scale", info["scale"], as_text)
            same("xyz variant", info["variant"], "fluid=still,amplitude_rad=0.0833")
            same("xyz seed", info["seed"], 7)
        with h5py.File(folder / f"texts_{k}.h5md") as file:
            same("h5 text", file["parameters"].attrs["experiment"].decode(), name)


def check_facts():
    facts = json.loads((folder / "vtk/run.json").read_text())
    for key, value in frames[0]["facts"].items():
        same("run.json " + key, facts[key] if key in facts else facts["parameters"][key], value)
    for f, got in zip(frames, facts["frames"], strict=True):
        for key, value in {**f["scalars"], "checkpoint": f["checkpoint"], "cycle": f["cycle"]}.items():
            same("run.json " + key, got[key], value)


def read_vtp(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def check_vtk():
    assert (folder / "vtk/frames.pvd").read_text().count("<DataSet ") == 2 * len(frames)
    for f in frames:
        data = read_vtp(folder / f"vtk/grains_{f['cycle']:g}.vtp")
        equal("vtk position", vtk_to_numpy(data.GetPoints().GetData()), f["position"])
        assert data.GetNumberOfVerts() == len(f["id"])
        for name in REAL + INTEGER + ["type", "id", "radius", "velocity"]:
            equal("vtk " + name, vtk_to_numpy(data.GetPointData().GetArray(name)), f[name])
        for name, value in {**f["scalars"], "cycle": f["cycle"]}.items():
            same("vtk " + name, data.GetFieldData().GetArray(name).GetValue(0), value)
        cell = read_vtp(folder / f"vtk/cell_{f['cycle']:g}.vtp")
        corners = vtk_to_numpy(cell.GetPoints().GetData())
        assert cell.GetNumberOfPolys() == 6
        equal("vtk corner", corners[0], f["origin"])
        equal("vtk far corner", corners[7], f["origin"] + f["edges"].sum(axis=0), 1e-15)


def check_lammps():
    for f in frames:
        path = folder / f"lammps/frame_{f['cycle']:g}.data"
        style = "id type diameter density x y z ix iy iz"
        universe = MDAnalysis.Universe(str(path), format="DATA", atom_style=style)
        equal("lammps position", universe.atoms.positions, f["position"], 1e-6)
        # It takes them for units real and converts.
        equal("lammps velocity", universe.atoms.velocities, f["velocity"] * 1e-3, 1e-6)
        equal("lammps type", universe.atoms.types.astype(int), f["type"] + 1)
        # Every digit, by plain reading.
        lines = path.read_text().splitlines()
        start = lines.index("Atoms # sphere") + 2
        rows = np.array([line.split() for line in lines[start : start + len(f["id"])]], dtype=float)
        equal("lammps id", rows[:, 0], f["id"])
        equal("lammps diameter", rows[:, 2], 2 * f["radius"])
        equal("lammps xyz", rows[:, 4:7], f["position"])
        mass = rows[:, 3] * np.pi / 6 * rows[:, 2] ** 3
        equal("lammps mass", mass, np.full(len(mass), f["mass"]), 1e-14)
        start = lines.index("Velocities") + 2
        rows = np.array([line.split() for line in lines[start : start + len(f["id"])]], dtype=float)
        equal("lammps velocities", rows[:, 1:4], f["velocity"])
        box = {l.split()[-1]: [float(w) for w in l.split()[:-2]] for l in lines if l.endswith("hi")}
        for axis, name in enumerate("xyz"):
            low, high = box[name + "hi"]
            at = f["position"][:, axis]
            assert np.all((at >= low) & (at <= high)), f"a particle is outside of the box in {name}"
        assert not any(l.endswith("xy xz yz") for l in lines), "the box is not upright"
        words = lines[0].split()
        cell = np.array(words[words.index("cell") + 1 : words.index("tilt")], dtype=float)
        origin, edges = f["origin"], np.array(f["edges"])
        equal("lammps cell", cell[::2], [origin[0], origin[1], 0])
        equal("lammps cell", cell[1::2], [origin[0] + edges[0, 0], origin[1] + edges[1, 1], edges[2, 2]], 1e-15)
        same("lammps tilt", float(words[-1]), edges[1, 0])


def check_lammps_measures():
    """LAMMPS's own stress per atom, contacts and pair counts, of grains away from the walls."""
    lammps = shutil.which("lmp") or shutil.which("lammps")
    if lammps is None:
        return print("without LAMMPS (Debian package lammps)")
    f = frames[0]
    deck = f"""units si
atom_style sphere
boundary f f p
newton off
comm_modify vel yes cutoff {2.0 * 2 * f['radius'][0]:.17g}
read_data lammps/frame_{f['cycle']:g}.data
pair_style gran/hooke {f['facts']['stiffness_N_per_m']:.17g} 0 0 0 0 0
pair_coeff * *
neighbor 0.001 bin
timestep 1e-5
group inner id {" ".join(str(i) for i in f["inner_id"])}
compute stress all stress/atom NULL pair
compute contacts all contact/atom
dump out all custom 1 stress.dump id c_stress[1] c_stress[2] c_stress[3] c_stress[4] c_stress[5] c_stress[6] c_contacts
dump_modify out sort id format float %.17g
run 0
undump out
# Without the keyword cutoff, which sets no bin width in LAMMPS of 4 Feb 2025: the bins end at the pair style's cutoff.
pair_style zero {1.5 * 2 * f['radius'][0]:.17g}
pair_coeff * *
compute pairs inner rdf 75
fix pairs all ave/time 1 1 1 c_pairs[*] file pairs.txt mode vector
run 0
"""
    run = subprocess.run([lammps, "-log", "none", "-screen", "none"], input=deck, text=True, cwd=folder)
    assert run.returncode == 0, "LAMMPS failed"
    rows = np.loadtxt(folder / "stress.dump", skiprows=9)
    stress = -rows[f["inner_id"] - 1, 1:7].sum(axis=0) / f["inner_volume"]
    equal("LAMMPS stress", stress, f["inner_stress"], 1e-10)
    equal("LAMMPS contacts", rows[f["inner_id"] - 1, 7], f["inner_contacts"])
    # Its last column is the number of pairs up to a distance, per grain.
    pairs = np.loadtxt(folder / "pairs.txt", skiprows=4)[:, 3] * len(f["inner_id"]) / 2
    equal("LAMMPS pairs", pairs, f["inner_pairs"], 1e-6)


check_h5md()
check_extxyz("run.xyz", "d")
check_extxyz("metres.xyz", "m")
check_texts()
check_facts()
check_vtk()
check_lammps()
check_lammps_measures()
print(f"{compared} numbers in {len(frames)} frames agree")
