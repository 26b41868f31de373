# SPDX-License-Identifier: GPL-3.0-or-later
"""One checkpoint as arrays."""
from __future__ import annotations

import functools
import hashlib
import io
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import ase

    from .store import Run

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


# Names of these measures in the program's exports.
GRAIN_MEASURES = ("q6", "phi_local", "overlap", "contacts", "grain_pressure_Pa", "structure",
                  "lattice", "crystallite", "displacement_d", "d2min_d2")


def _of_grains(name: str, doc: str) -> Any:
    """A property that gives the measure `name` of the grains."""
    return property(lambda checkpoint: checkpoint._measured[name], doc=doc)


class Checkpoint:
    """A state of N grains and M wall grains. Lengths are in grain diameters d, times in seconds.

    Arrays of grains are in the order of the grains' ids. x runs across the cell, y upwards (between
    the bottom and the top wall), z along the periodic depth.

    Attributes:
        run: the Run that it belongs to.
        sha256: SHA-256 of the file of the checkpoint.
        cycle: cycles since the shear began.
        step: time steps since the stage began.
        time_s: simulated time since the stage began [s].
        theta: tilt of the side walls [rad].
        diameter_m: d [m].
        mass_kg: mass of a grain [kg].
        position: (N, 3) [d]; z is not folded back into the cell.
        velocity: (N, 3) [d/s].
        wall_position: (M, 3) [d], centres of the M wall grains; smooth walls are planes and have none.
        wall_velocity: (M, 3) [d/s], from the tilt of the side walls and the motion of the moving wall.
        wall_side: (M,) 1 left, 2 right, 3 bottom, 4 top.
        cell: (3, 3) [d], the edges of the cell as rows; only the third is periodic.
        origin: (3,) [d], its lower left corner.
        observables: numbers that the program recorded with the state, by name.
    """

    def __init__(self, run: "Run", record: dict[str, Any]) -> None:
        content = (run.store.path / record["file"]).read_bytes()
        found = hashlib.sha256(content).hexdigest()
        if found != record["sha256"]:
            raise ValueError(f"{record['file']} is damaged: its SHA-256 is {found}")
        self.run = run
        self.sha256: str = record["sha256"]
        self.observables: dict[str, float] = record["observables"]
        with h5py.File(io.BytesIO(content), "r") as file:
            state = file["restart"]
            self.cycle = float(state.attrs["cycle"])
            self.step = int(state.attrs["step"])
            self.time_s = float(state.attrs["time_s"])
            self.theta = float(state.attrs["theta"])
            self.diameter_m = float(state.attrs["diameter_m"])
            self.mass_kg = float(state.attrs["mass_kg"])
            self.position: Floats = state["position"][:]
            self.velocity: Floats = state["velocity"][:]
            every = file["particles/all"]
            grains = len(self.position)
            self.wall_position: Floats = every["position/value"][0, grains:] / self.diameter_m
            self.wall_side: Integers = every["species"][grains:].astype(np.int64)
            self.cell, self.origin = _cell(state, self.theta)

    @property
    def grains(self) -> int:
        """N, the number of grains."""
        return len(self.position)

    @functools.cached_property
    def _measured(self) -> dict[str, NDArray[Any]]:
        # The program computes the Voronoi cells, so that these numbers and the figures agree.
        with tempfile.TemporaryDirectory(prefix="shearcell-python-") as folder:
            file = Path(folder) / "checkpoint.h5"
            self.run.store.call("export", self.run.id, "--to", "h5md", "--cycles",
                                repr(self.cycle), "--out", file)
            with h5py.File(file, "r") as exported:
                every = exported["particles/all"]
                found = {name: every[name + "/value"][0, : self.grains] for name in GRAIN_MEASURES}
                found["wall_velocity"] = every["velocity/value"][0, self.grains:] / self.diameter_m
                return found

    @property
    def wall_velocity(self) -> Floats:
        return self._measured["wall_velocity"]

    q6 = _of_grains("q6", "(N,) bond order of each grain, Eq. S1.")
    phi_local = _of_grains("phi_local", "(N,) local volume fraction.")
    overlap = _of_grains("overlap", "(N,) largest overlap of each grain [d].")
    contacts = _of_grains("contacts", "(N,) contacts with grains and wall grains.")
    pressure_Pa = _of_grains("grain_pressure_Pa", "(N,) pressure of a grain's contacts in its Voronoi cell [Pa].")
    structure = _of_grains("structure", "(N,) by q6: 0 disordered, 1 FCC, 2 HCP.")
    lattice = _of_grains("lattice", "(N,) by common neighbours: 0 none, 1 FCC, 2 HCP, 3 BCC.")
    crystallite = _of_grains(
        "crystallite", "(N,) crystallite of each grain: 0 none; 1, 2, ... by their lowest grain id.")
    displacement = _of_grains(
        "displacement_d", "(N,) distance since the previous cycle [d]; NaN if that cycle is not stored.")
    d2min = _of_grains(
        "d2min_d2", "(N,) non-affine part D^2_min of this motion [d^2]; NaN if the previous cycle is not stored.")

    def to_ase(self) -> "ase.Atoms":
        """ase.Atoms of the N grains and M wall grains; needs ASE.

        Lengths are in grain diameters (`info["d_m"]` is d [m]), velocities (array "velo") in d/s.
        H is a grain, He a wall grain. The arrays "wall_side" (0 for a grain) and GRAIN_MEASURES have the
        values of the program's export to extxyz.
        """
        import ase

        walls = len(self.wall_position)
        position = self.position.copy()
        position[:, 2] %= self.cell[2, 2]
        atoms = ase.Atoms(
            numbers=[1] * self.grains + [2] * walls,
            positions=np.concatenate([position, self.wall_position]),
            cell=self.cell,
            pbc=(False, False, True),
            info={"run": self.run.id, "variant": self.run.variant, "seed": self.run.seed,
                  "cycle": self.cycle, "Time": self.time_s, "Origin": self.origin,
                  "d_m": self.diameter_m},
        )
        atoms.set_array("wall_side", np.concatenate([np.zeros(self.grains, int), self.wall_side]))
        atoms.set_array("velo", np.concatenate([self.velocity, self.wall_velocity]))
        for name in GRAIN_MEASURES:
            missing = -1 if name in ("structure", "lattice", "crystallite") else 0
            atoms.set_array(name, np.concatenate([self._measured[name], np.full(walls, missing)]))
        return atoms

    def __repr__(self) -> str:
        return f"<Checkpoint {self.sha256[:12]} cycle {self.cycle:g}, {self.grains} grains>"


def _cell(state: h5py.Group, theta: float) -> tuple[Floats, Floats]:
    """Edges and origin of the cell [d]. The top wall is fixed in x, so the bottom one shifts."""
    walls = state["cell"].attrs
    bottom, top, moving = float(walls["bottom"]), float(walls["top"]), int(walls["moving"])
    if moving == 0:
        bottom = float(state.attrs["wall_height"])
    else:
        top = float(state.attrs["wall_height"])
    height = top - bottom
    shift = height * np.tan(theta)
    edges = np.array([[walls["width"], 0, 0], [shift, height, 0], [0, 0, walls["depth"]]], float)
    return edges, np.array([-shift, bottom, 0.0])
