#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python package against the program, on a small store: python3 test_shearcell.py PROGRAM SOURCE"""
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

program, source = sys.argv[1:3]
del sys.argv[1:3]
os.environ["SHEARCELL"] = program
os.environ["PYTHONPATH"] = f"{source}/experiments/python"
sys.path.insert(0, os.environ["PYTHONPATH"])
sys.dont_write_bytecode = True
try:
    import ase.io
    import h5py  # noqa: F401
    import matplotlib  # noqa: F401
    import numpy as np
    import pandas
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)
from shearcell.checkpoint import GRAIN_MEASURES
from shearcell import ShearcellError, Store

calls = 0


def spread(state):
    """Standard deviation of x and mean y [d]."""
    global calls
    calls += 1
    return {"x_d": state.position[:, 0].std(), "y_d": state.position[:, 1].mean()}


def unknown(state):
    """As a measure over two checkpoints where the earlier one is missing."""
    global calls
    calls += 1
    return np.nan


def bytes_of(folder):
    """Every file of the record; derived.sqlite is the program's cache."""
    files = sorted(p for p in folder.rglob("*") if p.is_file() and p.name != "derived.sqlite")
    return {str(p): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.path = cls.folder / "shearcell-store"
        subprocess.run([program, "run", f"{source}/experiments/drag.yaml", "--scale", "smoke", "-q",
                        "--seeds", "1", "--cycles", "2", "--store", str(cls.path)], check=True)
        cls.before = bytes_of(cls.path)
        cls.store = Store(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def tearDown(self):
        self.assertEqual(bytes_of(self.path), self.before, "something wrote into the store")

    def test_table_is_that_of_the_program(self):
        for per, rows in (("checkpoint", 6), ("run", 2)):
            table = self.store.table(per=per)
            self.assertEqual(len(table), rows)
            printed = json.loads(self.store.call("table", "--per", per, "--format", "json"))
            self.assertEqual(len(printed), rows)
            for row, expected in zip(table.to_dict("records"), printed):
                for key, value in expected.items():
                    same = pandas.isna(row[key]) if value in (None, "") else row[key] == value
                    self.assertTrue(same, f"{key}: {row[key]!r}, not {value!r}")
        self.assertEqual(set(self.store.table(variant="fluid=cell")["fluid"]), {"cell"})
        g = self.store.table(curve="pair_correlation")
        self.assertEqual(len(g), len(g.groupby(["run", "cycle", "distance_d"])))
        self.assertEqual(g[g.distance_d < 0.9].pair_correlation.max(), 0)
        self.assertGreater(g.pair_correlation.max(), 3)

    def test_checkpoint_is_what_the_program_exports(self):
        for run in self.store.runs():
            state = run.checkpoint(1)
            file = self.folder / f"{run.id}.xyz"
            self.store.call("export", run.id, "--to", "extxyz", "--cycles", "1", "--out", str(file))
            exported, own = ase.io.read(file), state.to_ase()
            self.assertEqual(exported.info["checkpoint"], state.sha256)
            self.assertEqual(exported.info["d_m"], own.info["d_m"])
            self.assertEqual(list(exported.symbols), list(own.symbols))
            for what, a, b in (("position", exported.positions, own.positions),
                               ("cell", exported.cell.array, own.cell.array),
                               ("origin", exported.info["Origin"], own.info["Origin"])):
                self.assertLess(np.max(np.abs(a - b)), 1e-13, what)
            self.assertEqual(state.position.shape, (600, 3))
            velocity = own.arrays["velo"]
            self.assertLess(np.max(np.abs(exported.arrays["velo"] - velocity)), 1e-14 * np.max(velocity))
            for name in ("type", *GRAIN_MEASURES):
                self.assertTrue(np.array_equal(exported.arrays[name], own.arrays[name]), name)
            moved = state.position - run.checkpoint(0).position  # both upright
            self.assertLess(np.max(np.abs(state.displacement - np.linalg.norm(moved, axis=1))), 1e-12)
            rows = self.store.table(seed=run.seed, variant=run.variant)
            interior = rows[rows.cycle == 1].iloc[0]
            self.assertGreater(interior["msd_1_cycle_d2"], 0)
            self.assertTrue(np.all(np.isnan(run.checkpoint(0).d2min)))
            self.assertTrue(np.all(state.d2min[~np.isnan(state.d2min)] >= 0))
            self.assertEqual(run.parameters["fluid"], run.variant.split("=")[1])
            self.assertNotIn("max_overlap_diameters", run.parameters)
            self.assertEqual([c.cycle for c in run.checkpoints()], run.cycles)

    def test_a_shared_run_has_the_cycles_of_its_experiment(self):
        copy = self.folder / "shared"
        shutil.copytree(self.path, copy)
        text = pathlib.Path(source, "experiments/drag.yaml").read_text()
        other = self.folder / "other.yaml"
        other.write_text(text.replace("experiment: drag", "experiment: other"))
        subprocess.run([program, "run", str(other), "--scale", "smoke", "-q", "--seeds", "1", "--cycles", "3",
                        "--store", str(copy)], check=True)
        store = Store(copy)
        for experiment, cycles in (("drag", [0, 1, 2]), ("other", [0, 1, 2, 3])):
            run = store.runs(experiment=experiment)[0]
            table = store.table(experiment=experiment, variant=run.variant)
            self.assertEqual(run.cycles, cycles)
            self.assertEqual(run.cycles, list(table["cycle"]))
            self.assertEqual(run.checkpoint().cycle, cycles[-1])
            self.assertEqual([c.cycle for c in run.checkpoints()], cycles)
            self.assertEqual(run.checkpoint(3).cycle, 3)
            self.assertEqual(len(run.records()), 4)
        store.call("prune", "--keep-every", "2", "--yes")
        run = store.runs(experiment="drag")[0]
        self.assertEqual(run.cycles, [0, 2])
        with self.assertRaisesRegex(KeyError, "at cycle 1 was pruned; `shearcell regenerate [0-9a-f]+`"):
            run.checkpoint(1)

    def test_own_measure_is_kept_beside_the_store(self):
        global calls
        calls = 0
        first = self.store.measure(spread)
        self.assertEqual((len(first), calls), (6, 6))
        self.assertEqual(first["y_d"][0], self.store.run(first["run"][0]).checkpoint(0).position[:, 1].mean())
        kept = json.loads((self.folder / "shearcell-store.measures/spread.json").read_text())
        self.assertEqual(hashlib.sha256(kept["source"].encode()).hexdigest(), kept["source_sha256"])
        self.assertEqual(set(kept["checkpoints"]), set(first["checkpoint"]))
        self.assertTrue(first.equals(self.store.measure(spread)))
        self.assertEqual(calls, 6, "nothing is computed twice")
        seed = self.store.measure(spread, fresh=True, seed=first["seed"][0])
        self.assertEqual(calls, 6 + len(seed))
        self.assertTrue(first.equals(self.store.measure(spread)))
        self.assertEqual(calls, 6 + len(seed), "those of other runs stay")
        calls = 0
        for times in (1, 2):
            self.assertTrue(self.store.measure(unknown)["unknown"].isna().all())
            self.assertEqual(calls, 6 * times, "it may become known")

        # Another function of that name.
        other = self.folder / "other.py"
        other.write_text("def spread(state):\n    return 2\n")
        sys.path.insert(0, str(self.folder))
        import other as changed

        self.assertEqual(list(self.store.measure(changed.spread)["spread"]), [2.0] * 6)

    def test_results_that_cannot_be_kept_are_returned(self):
        copy = self.folder / "full"
        shutil.copytree(self.path, copy)
        (self.folder / "full.measures").write_text("a file in the place of the folder")
        with self.assertWarnsRegex(UserWarning, "unknown are not kept"):
            self.assertEqual(len(Store(copy).measure(unknown)), 6)

    def test_errors_say_what_is_wrong(self):
        run = self.store.runs()[0]
        with self.assertRaisesRegex(KeyError, "it has those of cycles"):
            run.checkpoint(17)
        with self.assertRaisesRegex(KeyError, "0 runs begin with"):
            self.store.run("not a run")
        with self.assertRaisesRegex(ShearcellError, "did you mean fluid=cell"):
            self.store.table(variant="fluid=cel")
        with self.assertRaisesRegex(FileNotFoundError, "is not a store"):
            Store(self.folder / "nowhere")
        self.assertEqual(len(self.store.runs(seed=range(run.seed, run.seed + 1))),
                         len(self.store.runs(seed=run.seed)))
        with self.assertRaisesRegex(ValueError, "seed: no value is given"):
            self.store.runs(seed=[])
        with self.assertRaisesRegex(ValueError, "cannot name a measure"):
            self.store.measure(lambda state: 1.0)
        copy = self.folder / "damaged"
        shutil.copytree(self.path, copy)
        file = copy / run.records()[-1]["file"]
        file.write_bytes(file.read_bytes()[:-1] + b"?")
        with self.assertRaisesRegex(ValueError, "is damaged"):
            Store(copy).run(run.id).checkpoint()

    def test_tour(self):
        notebook = json.loads(pathlib.Path(source, "experiments/python/tour.ipynb").read_text())
        code = [c["source"] for c in notebook["cells"] if c["cell_type"] == "code"]
        lines = [line for cell in code for line in cell if line.strip()]
        self.assertLess(len(lines), 30)
        if shutil.which("jupyter-nbconvert", path="/usr/bin") is None:
            self.skipTest("needs jupyter-nbconvert and python3-ipykernel")
        shutil.copy(f"{source}/experiments/python/tour.ipynb", self.folder)
        done = subprocess.run(["/usr/bin/jupyter-nbconvert", "--to", "notebook", "--execute", "tour.ipynb",
                               "--output", "executed.ipynb"], cwd=self.folder, capture_output=True, text=True,
                              env={**os.environ, "MPLBACKEND": "agg"}, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("<svg", (self.folder / "displacement.svg").read_text())


if __name__ == "__main__":
    unittest.main(verbosity=2)
