#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python package against the program, on a small store: python3 test_shearcell.py PROGRAM SOURCE"""
import contextlib
import csv
import functools
import hashlib
import html
import importlib.util
import io
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import types
import unittest
import warnings

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
import shearcell
from shearcell.checkpoint import GRAIN_MEASURES
from shearcell import ShearcellError, Store
from shearcell.store import _text_of

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


def times(factor):
    return lambda state: factor * state.cycle


def with_default(factor):
    def scaled(state, factor=factor):
        return factor * state.cycle
    return scaled


def module_constant(state):
    return FACTOR * state.cycle


class Scale:
    def __init__(self, factor):
        self.factor = factor

    def __call__(self, state):
        return self.factor * state.cycle

    def method(self, state):
        return self.factor * state.cycle


def bytes_of(folder):
    """Every file of the record; derived.sqlite is the program's cache."""
    files = sorted(p for p in folder.rglob("*") if p.is_file() and p.name != "derived.sqlite")
    return {str(p): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


def multiplied(factor, state):
    return factor * state.cycle


def compute(store, *manifests, cycles=2, seeds=1):
    subprocess.run([program, "run", *manifests, "--scale", "smoke", "-q", "--seeds", str(seeds),
                    "--cycles", str(cycles), "--store", store], check=True)


def same_tables(one, other):
    pandas.testing.assert_frame_equal(one, other, check_exact=True)


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.path = cls.folder / "shearcell-store"
        compute(cls.path, f"{source}/experiments/drag.yaml")
        cls.before = bytes_of(cls.path)
        cls.store = Store(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def setUp(self):
        shutil.rmtree(self.folder / "shearcell-store.measures", ignore_errors=True)
        warnings.simplefilter("ignore", UserWarning)

    def drag(self, experiment, *replaced):
        """A copy of drag.yaml under another name, with pairs of old and new texts."""
        text = pathlib.Path(source, "experiments/drag.yaml").read_text(encoding="utf-8")
        for old, new in (("experiment: drag", f"experiment: {experiment}"), *replaced):
            self.assertEqual(text.count(old), 1)
            text = text.replace(old, new)
        file = self.folder / f"{experiment}.yaml"
        file.write_text(text, encoding="utf-8")
        return file

    def copy(self, name):
        shutil.copytree(self.path, self.folder / name)
        return self.folder / name

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
                    self.assertEqual(isinstance(row[key], str), isinstance(value, str), key)
            # As text, with the CSV's digits.
            lines = list(csv.DictReader(io.StringIO(self.store.call("table", "--per", per))))
            self.assertEqual(list(table), list(lines[0]))
            for row, expected in zip(table.to_dict("records"), lines):
                for key, value in expected.items():
                    same = pandas.isna(row[key]) if value == "" else type(row[key])(value) == row[key]
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
            for name in ("wall_side", *GRAIN_MEASURES):
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
        copy = self.copy("shared")
        compute(copy, self.drag("other"), cycles=3)
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

    def test_own_measure_is_kept_under_a_key(self):
        global calls
        calls = 0
        first = self.store.measure(spread, key="spread")
        self.assertEqual((len(first), calls), (6, 6))
        self.assertEqual(first["y_d"][0], self.store.run(first["run"][0]).checkpoint(0).position[:, 1].mean())
        kept = json.loads((self.folder / "shearcell-store.measures/spread.json").read_text())
        self.assertEqual(set(kept["checkpoints"]), set(first["checkpoint"]))
        same_tables(first, self.store.measure(spread, key="spread"))
        self.assertEqual(calls, 6, "nothing is computed twice")
        seed = self.store.measure(spread, key="spread", fresh=True, seed=first["seed"][0])
        self.assertEqual(calls, 6 + len(seed))
        same_tables(first, self.store.measure(spread, key="spread"))
        self.assertEqual(calls, 6 + len(seed), "those of other runs stay")
        calls = 0
        for time in (1, 2):
            self.assertTrue(self.store.measure(unknown, key="unknown")["unknown"].isna().all())
            self.assertEqual(calls, 6 * time, "it may become known")
        # Results are reused by key, even for another function. Another build of the program measures again.
        self.assertEqual(list(self.store.measure(times(2), key="y-2.0")["y-2.0"]), [0, 2, 4] * 2)
        self.assertEqual(list(self.store.measure(times(3), key="y-2.0")["y-2.0"]), [0, 2, 4] * 2)
        self.assertEqual(list(self.store.measure(times(3), key="y-2.0", fresh=True)["y-2.0"]), [0, 3, 6] * 2)
        file = self.folder / "shearcell-store.measures/y-2.0.json"
        file.write_text(file.read_text().replace(self.store.version(), "shearcell 0.0"))
        self.assertEqual(list(self.store.measure(times(4), key="y-2.0")["y-2.0"]), [0, 4, 8] * 2)
        file.write_text(file.read_text()[:-3])
        with self.assertRaisesRegex(ValueError, "y-2.0.json is damaged; delete it"):
            self.store.measure(times(4), key="y-2.0")
        # Results of an earlier version of this package may be those of another function.
        earlier = {sha256: {"y": 9.0} for sha256 in first["checkpoint"]}
        file.write_text(json.dumps({"measure": "y", "source": "", "checkpoints": earlier}))
        self.assertEqual(list(self.store.measure(times(5), key="y-2.0")["y-2.0"]), [0, 5, 10] * 2)
        for key in ("", "a/b", "../a", ".hidden", "a b", "-x", "ä", "x" * 101, 1):
            with self.assertRaisesRegex(ValueError, "cannot be a key"):
                self.store.measure(times(1), key=key)

    def test_nothing_is_kept_without_a_key(self):
        global FACTOR
        FACTOR = 2
        one, two = Scale(2), Scale(3)
        pairs = [(times(2), times(3), "<lambda>"), (with_default(2), with_default(3), "scaled"),
                 (one, two, "Scale"), (one.method, two.method, "method"),
                 (functools.partial(multiplied, 2), functools.partial(multiplied, 3), "multiplied"),
                 (functools.partial(functools.partial(multiplied), 2), functools.partial(Scale(3)), None)]
        for first, second, name in pairs:
            for function, factor in ((first, 2), (second, 3)):
                frame = self.store.measure(function)
                self.assertEqual(list(frame.iloc[:, -1]), [0, factor, 2 * factor] * 2, name)
                self.assertEqual(frame.columns[-1], name or frame.columns[-1])
        self.assertEqual(list(self.store.measure(module_constant)["module_constant"]), [0, 2, 4] * 2)
        FACTOR = 3
        self.assertEqual(list(self.store.measure(module_constant)["module_constant"]), [0, 3, 6] * 2)
        two.factor = 4  # the state of a callable
        self.assertEqual(list(self.store.measure(two)["Scale"]), [0, 4, 8] * 2)
        exec(compile("def module_constant(state): return 5 * state.cycle", "<input>", "exec"), scope := {})
        self.assertEqual(list(self.store.measure(scope["module_constant"])["module_constant"]), [0, 5, 10] * 2)
        self.assertFalse((self.folder / "shearcell-store.measures").exists())
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            store = Store(self.path)
            for _ in range(3):
                store.measure(module_constant)
            store.measure(module_constant, key="said")
        self.assertEqual(len(said), 1)
        self.assertRegex(str(said[0].message), "module_constant are not kept.*key=")

    def test_measure_has_the_rows_and_columns_of_the_table(self):
        copy = self.copy("swept")
        compute(copy, self.drag("again"), self.drag("swept", ("fluid: [still, cell]", "amplitude_rad: [0.05, 0.0833]")))
        store = Store(copy)

        def cycle_and_place(state):
            return {"own_cycle": state.cycle, "own_seed": state.run.seed, "own_drag": state.run.experiment == "drag"}

        whole = store.table()
        self.assertEqual(len(whole), 18)
        for select, table in (({}, whole), ({"state": "completed"}, whole), ({"state": ["failed", "completed"]}, whole),
                              ({"experiment": "drag"}, store.table(experiment="drag")),
                              ({"fluid": iter(["cell"])}, store.table(fluid="cell")),
                              ({"amplitude_rad": 0.05, "seed": 1}, store.table(amplitude_rad=0.05))):
            frame = store.measure(cycle_and_place, **select)
            same_tables(frame[list(table)], table)
            self.assertEqual(list(frame["own_cycle"]), list(frame["cycle"]))
            self.assertEqual(list(frame["own_seed"]), list(frame["seed"]))
            self.assertEqual(list(frame["own_drag"] == 1), list(frame["experiment"] == "drag"))
            self.assertTrue({"grains", "phi", "coordination", "time_s"} < set(frame))
        self.assertEqual(set(whole["amplitude_rad"]), {0.05, 0.0833})
        self.assertEqual(store.measure(times(1), experiment="drag", variant="fluid=still")["phi"].isna().sum(), 0)
        self.assertEqual(len(store.measure(times(1), key="none", state="failed")), 0)
        for name in ("phi", "cycle", "fluid", "experiment", "msd_1_cycle_d2"):
            with self.assertRaisesRegex(ValueError, f"has a column {name} already"):
                store.measure(lambda state: {name: 1.0})
            with self.assertRaisesRegex(ValueError, f"has a column {name} already"):
                store.measure(lambda state: 1.0, key=name)

    def test_a_pruned_checkpoint_has_its_kept_measures(self):
        copy = self.copy("pruned")
        store = Store(copy)
        before = store.measure(spread, key="spread")
        pruned = before["cycle"] == 1
        store.call("prune", "--keep-every", "2", "--yes")
        self.assertEqual(store.runs()[0].cycles, [0, 2])
        own = store.measure(times(2), key="new")
        same_tables(own[list(store.table())], store.table())
        self.assertEqual(list(own["phi"]), list(before["phi"]))
        self.assertEqual(list(own["new"].isna()), list(pruned))
        self.assertEqual(list(own["new"][~pruned]), [0, 4] * 2)
        for fresh in (False, True):  # nothing can compute it again
            kept = store.measure(spread, key="spread", fresh=fresh)
            same_tables(kept, before)
        file = self.folder / "pruned.measures/spread.json"
        file.write_text(file.read_text().replace(store.version(), "shearcell 0.0"))
        same_tables(store.measure(spread, key="spread"), before)
        same_tables(store.measure(spread, key="spread"), before)
        self.assertEqual(file.read_text().count("shearcell 0.0"), 2, "those of the pruned checkpoints alone")
        mixed = store.measure(lambda state: {"a": 1} if state.cycle == 0 else {"b": 2})
        self.assertEqual(list(mixed["a"].notna()), list(mixed["cycle"] == 0))
        self.assertEqual(list(mixed["b"].notna()), list(mixed["cycle"] == 2))
        # A function that needs a pruned checkpoint says so.
        with self.assertRaisesRegex(KeyError, "at cycle 1 was pruned"):
            store.measure(lambda state: state.run.checkpoint(1).cycle)
        store.call("regenerate", before["checkpoint"][1])
        self.assertEqual(store.measure(times(2), key="new")["new"].isna().sum(), 1)

    def test_text_stays_text(self):
        copy = self.copy("names")
        names = ["007", "1e3", "F", "NA", "None", "True", "inf", "nan", "off"]
        files = [self.drag(name) for name in names]
        with open(files[0], "a", encoding="utf-8") as manifest:
            manifest.write('labels: {"fluid=still": "12", "fluid=cell": "Öl φ"}\n')
        compute(copy, *files)
        store = Store(copy)
        every = sorted([*names, "drag"])
        for table in (store.table(), store.table(per="run"), store.measure(times(1)),
                      store.table(curve="pair_correlation")):
            self.assertEqual(sorted(table.groupby("experiment").size().index), every)
            for column in ("experiment", "scale", "variant", "run", "fluid", "checkpoint"):
                self.assertTrue(table[column].map(lambda value: isinstance(value, str)).all(), column)
            self.assertEqual(set(table[table["experiment"] == "007"]["variant"]), {"12", "Öl φ"})
        for name in every:
            self.assertEqual(set(store.table(experiment=name)["experiment"]), {name})
            self.assertEqual(store.table(experiment=name)["cycle"].dtype, float)
        self.assertEqual(len(store.table(experiment=names, seed=1)), 6 * len(names))
        # Whatever Python takes for the encoding of the locale.
        code = ("import shearcell, sys; table = shearcell.Store(sys.argv[1]).table(experiment='007'); "
                "print(ascii(sorted(set(table['variant']))), len(table))")
        for variables in ({"LC_ALL": "C"}, {"LC_ALL": "", "LANG": "C"},
                          {"LC_ALL": "POSIX", "PYTHONIOENCODING": "ascii"},
                          {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
                          {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "latin-1"}):
            done = subprocess.run([sys.executable, "-B", "-c", code, str(copy)], capture_output=True, text=True,
                                  env={**os.environ, **variables}, check=False)
            self.assertEqual((done.stdout, done.returncode), ("['12', '\\xd6l \\u03c6'] 6\n", 0), done.stderr)

    def test_an_empty_table_has_its_columns(self):
        copy = self.copy("empty")
        compute(copy, self.drag("one"), seeds=2, cycles=0)
        store = Store(copy)
        none = store.table(experiment="drag", seed=2)
        self.assertEqual(len(none), 0)
        # No selected run sweeps a parameter.
        self.assertEqual(list(none), [name for name in store.table(experiment="drag") if name != "fluid"])
        self.assertEqual(list(store.measure(times(1), key="y", experiment="drag", seed=2))[-1], "y")

    def test_runs_are_selected_by_swept_parameters(self):
        copy = self.copy("sweep")
        grid = "fluid: [still, cell]"
        compute(copy, self.drag("sweep", (grid, grid + "\n    amplitude_rad: [0.03, 0.05, 0.1]")), cycles=0)
        store = Store(copy)

        def chosen(**select):
            return sorted((run.parameters["amplitude_rad"], run.parameters["fluid"]) for run in
                          store.runs(experiment="sweep", **select))

        both = ("cell", "still")
        for value in (0.03, "0.03", 3e-2, np.float64(0.03), "3e-2", np.float32(0.03)):
            self.assertEqual(chosen(amplitude_rad=value), [(0.03, fluid) for fluid in both], value)
        for values in ([0.03, 0.1], (0.1, 0.03), {0.03, 0.1}, np.array([0.03, 0.1]), iter([0.03, 0.1])):
            self.assertEqual(chosen(amplitude_rad=values), [(a, fluid) for a in (0.03, 0.1) for fluid in both])
        self.assertEqual(chosen(amplitude_rad=[0.03, 0.05], fluid="cell"), [(0.03, "cell"), (0.05, "cell")])
        self.assertEqual(chosen(amplitude_rad=0.1, variant="fluid=still", state="completed"), [(0.1, "still")])
        table = store.table(amplitude_rad=0.05)
        self.assertEqual(set(table["amplitude_rad"]), {0.05})
        self.assertEqual(len(store.measure(times(1), key="y", amplitude_rad=0.05)), len(table))
        for wrong in ({"amplitude_rad": 0.031}, {"amplitude_rad": 0.0300001}, {"gravity_m_per_s2": 9.81}, {"seeds": 1},
                      {"fluid": "cel"}):
            with self.assertRaisesRegex(ShearcellError, f"no run of the store has variant {next(iter(wrong))}="):
                store.runs(**wrong)

    def test_cycles_are_found_as_near_as_a_time_step(self):
        copy = self.copy("phases")
        every = "every_cycles: 1"
        compute(copy, self.drag("phases", (every, every + "\n  phases: [0.3, 0.33333, 0.7]")), cycles=1)
        run = Store(copy).runs(experiment="phases")[0]
        third = run.cycles[2]
        self.assertEqual(len(run.cycles), 5)
        for asked, found in ((0.1 + 0.2, 0.3), (1 - 0.7, 0.3), (0.3, 0.3), (0.1 * 7, 0.7), (np.float32(0.7), 0.7),
                             (1 - 0.1 * 3, 0.7), (0.1 * 3 - 0.3, 0), (1 + 1e-12, 1), (sum([0.1] * 10), 1),
                             (third, third)):
            self.assertAlmostEqual(run.checkpoint(asked).cycle, found, 9, asked)
        for asked, near in ((0.31, "0, 0.3, 0.333"), (0.30001, "0, 0.3, 0.333"), (0.9, "0.333.*, 0.7, 1"),
                            (17, "0.7, 1, 2"), (-1, "0, 0.3, 0.333"), (1 + 1 / 45600, "0.333.*, 0.7, 1"), (np.nan, "")):
            with self.assertRaisesRegex(KeyError, f"has no checkpoint at cycle .*; the nearest checkpoints are at cycles {near}"):
                run.checkpoint(asked)

    def test_the_working_directory_may_change(self):
        here = os.getcwd()
        try:
            os.chdir(self.folder)
            os.symlink(program, self.folder / "linked")
            store = Store("shearcell-store", program="./linked")
            run = store.runs()[0]
            os.chdir("/")
            self.assertEqual(store.path, self.path)
            same_tables(store.table(), self.store.table())
            self.assertEqual(run.checkpoint(1).q6.shape, (600,))
            store.measure(times(1), key="moved")
            self.assertTrue((self.folder / "shearcell-store.measures/moved.json").is_file())
            os.chdir(self.path)
            self.assertEqual(Store(".").path, self.path)
            self.assertEqual(Store("../shearcell-store").runs()[0].id, run.id)
        finally:
            os.chdir(here)

    def pip(self, package, *options):
        """pip without network, in a clone's place; skips the test where there is no pip."""
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        if importlib.util.find_spec("pip") is None:
            self.skipTest("needs python3-pip")
        return subprocess.run([sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--quiet",
                               "--break-system-packages", *options, str(package)],
                              capture_output=True, text=True, env=environment, check=False)

    def test_pip_installs_it_from_a_clone(self):
        clone, there = self.folder / "clone", self.folder / "there"
        shutil.copytree(f"{source}/experiments/python", clone / "experiments/python",
                        ignore=shutil.ignore_patterns("build", "*.egg-info", "__pycache__"))
        shutil.copy(f"{source}/CMakeLists.txt", clone)
        before = sorted(clone.rglob("*"))
        # Neither setuptools nor the network is needed to build it.
        done = self.pip(clone / "experiments/python", "--target", there)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(clone.rglob("*")), before, "something was left in the clone")
        code = ("import importlib.metadata, shearcell, sys; print(importlib.metadata.version('shearcell'), "
                "len(shearcell.Store(sys.argv[1]).runs()), shearcell.__file__)")
        done = subprocess.run([sys.executable, "-B", "-c", code, str(self.path)], capture_output=True, text=True,
                              cwd="/", env={**os.environ, "PYTHONPATH": str(there)}, check=False)
        version = self.store.version().split()[1]
        self.assertEqual(done.stdout, f"{version} 2 {there}/shearcell/__init__.py\n", done.stderr)

    def test_pip_says_what_to_do_with_a_copy(self):
        copy = self.folder / "copied"
        shutil.copytree(f"{source}/experiments/python", copy, ignore=shutil.ignore_patterns("__pycache__"))
        before = sorted(copy.rglob("*"))
        done = self.pip(copy, "--target", self.folder / "nowhere")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("pip install CLONE/experiments/python", done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        self.assertEqual(sorted(copy.rglob("*")), before)

    QUESTION = {"experiment": "asked", "base": {"grains": 200, "amplitude_rad": 0.1, "cycles": 1, "steps_per_cycle": 20000},
                "sweep": {"grid": {"fluid": ["still", "cell"]}}, "seeds": 1,
                "checkpoints": {"every_cycles": 1},
                "plots": [{"name": "compaction", "y": "phi", "x": "cycle"}],
                "claims": [{"name": "same", "compare": "phi", "at_cycle": 1,
                            "between": [{"fluid": "still"}, {"fluid": "cell"}], "margin": 0.005}]}

    def hashes(self, store):
        return {run.id: run.facts["state_hash"] for run in Store(store).runs()}

    def inside(self, folder):
        """Works in that new folder until the test ends."""
        (self.folder / folder).mkdir()
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder / folder)

    def test_run_takes_a_path_a_text_or_a_dict(self):
        self.inside("computed")
        planned = shearcell.plan(self.QUESTION)
        self.assertEqual(list(planned["stage"]), ["prepare", "shear", "shear"])
        self.assertAlmostEqual(planned["core_seconds_left"].sum() / planned.attrs["cores"],
                               planned.attrs["seconds_left"], delta=0.5 * planned.attrs["seconds_left"])
        # By hand what the dict states.
        text = ("experiment: asked\nbase: {grains: 200, amplitude_rad: 0.1, cycles: 1, steps_per_cycle: 20000}\n"
                "sweep:\n  grid:\n    fluid: [still, cell]\nseeds: 1\ncheckpoints: {every_cycles: 1}\n")
        pathlib.Path("asked.yaml").write_text(text)
        subprocess.run([program, "run", "asked.yaml", "-q", "--store", "program"], check=True, stdout=subprocess.DEVNULL)
        for manifest in (self.QUESTION, text, "asked.yaml", pathlib.Path("asked.yaml"), [text],
                         {**self.QUESTION, "seeds": np.int64(1),
                          "base": {**self.QUESTION["base"], "amplitude_rad": np.float64(0.1)}}):
            store = shearcell.run(manifest, jobs=2)
            self.assertEqual([run.state for run in store.runs()], ["completed"] * 2)
            self.assertEqual(self.hashes(store.path), self.hashes("program"))
        self.assertEqual(store.path, pathlib.Path("shearcell-store").absolute())
        self.assertEqual(shearcell.plan(text)["state"].tolist(), ["done"] * 3)
        self.assertEqual(len(shearcell.run(self.QUESTION, store=store, seeds=2, variant="fluid=cell").runs(seed=2)), 1)
        self.assertEqual({p.name for p in pathlib.Path().iterdir()},
                         {"asked.yaml", "program", "shearcell-store"}, "a file was left behind")

    def test_plan_takes_the_arguments_of_run(self):
        self.inside("planned")
        with self.assertWarnsRegex(UserWarning, "^manifest: claim same: a verdict needs at least 3 seeds"):
            planned = shearcell.plan(self.QUESTION, None, "store", 3, threads=2, mpi=2, keep_every=5, quiet=True)
        self.assertEqual([line[:22] for line in planned.attrs["warnings"] if "claim" in line], ["manifest: claim same: "])
        with self.assertRaisesRegex(TypeError, "help"):
            shearcell.plan(self.QUESTION, help=True)

    def test_a_text_may_have_one_line(self):
        self.inside("lines")
        for text in ("{experiment: asked, base: {grains: 150}}", json.dumps(self.QUESTION), '{"experiment":"asked"}'):
            self.assertEqual(set(shearcell.plan(text)["experiment"]), {"asked"}, text)
        with self.assertRaisesRegex(ShearcellError, "(?m)^manifest:1:2: exp: is an unknown key"):
            shearcell.plan("{exp: asked}")
        for nothing, shown in (("", "not ''"), (b"experiment: asked", "not b'exp"), ([], "this list is empty"), (5, "not 5")):
            with self.assertRaisesRegex(TypeError, f"a manifest is a path, a text or a dict.*{shown}"):
                shearcell.plan(nothing)

    def test_numbers_of_a_dict_are_finite_and_whole_if_they_can_be(self):
        self.inside("numbers")
        base = self.QUESTION["base"]
        planned = shearcell.plan({**self.QUESTION, "base": {**base, "grains": np.float64(150), "amplitude_rad": 0.125}},
                                 cycles=3.0, seeds=np.float32(2))
        self.assertEqual((set(planned["N"]), set(planned["seed"])), ({150}, {1, 2}))
        self.assertEqual(set(planned[planned["stage"] == "shear"]["cycles"]), {3})
        for value, key in (({**base, "cycles": np.nan}, "base.cycles: nan"), (np.array([1, np.inf]), r"base\[1\]: inf"),
                           ({"grains": object()}, "base.grains: <object")):
            with self.assertRaisesRegex((ValueError, TypeError), f"^{key}"):
                shearcell.plan({**self.QUESTION, "base": value})

    def test_paths_begin_at_home_or_in_the_working_directory(self):
        self.inside("paths")
        home = os.environ.get("HOME")
        self.addCleanup(lambda: os.environ.pop("HOME") if home is None else os.environ.update(HOME=home))
        os.environ["HOME"] = str(self.folder / "paths")
        pathlib.Path("asked.yaml").write_text(json.dumps(self.QUESTION))
        self.assertEqual(len(shearcell.plan("~/asked.yaml", store="~/store")), 3)
        os.symlink(self.path, "drag")
        store = Store("~/drag")
        self.assertEqual(store.report("~/page.html"), pathlib.Path("page.html").absolute())
        with self.assertRaisesRegex(ShearcellError, "this is a folder.*with out=$"):
            store.report("~")
        self.assertTrue(pathlib.Path("page.html").is_file())
        with self.assertRaisesRegex(ShearcellError, "^packing.xyz: there is no such file"):
            shearcell.plan({**self.QUESTION, "start": {"file": "packing.xyz"}})

    def test_errors_of_a_run_have_a_sentence_and_a_code(self):
        self.inside("wrong")
        base = self.QUESTION["base"]
        for manifest, how, code, sentence in (
                ({**self.QUESTION, "sede": 1}, {}, 2, "^manifest: sede: .*Did you mean seeds"),
                ({**self.QUESTION, "base": {**base, "grains": -1}}, {}, 2, "^manifest: base.grains: "),
                ("nowhere.yaml", {}, 2, "nowhere.yaml"), (self.QUESTION, {"scale": "desk"}, 2, "scale"),
                (self.QUESTION, {"cycles": 0.5}, 2, "^cycles: must be a whole number"),
                (self.QUESTION, {"seed": 7}, 2, r"\(seeds= sets the number of seeds\)"),
                ({**self.QUESTION, "base": {**base, "max_overlap_diameters": 1e-6}}, {}, 3, "unstable")):
            with self.assertRaisesRegex(ShearcellError, sentence) as raised:
                shearcell.run(manifest, **how)
            self.assertEqual(raised.exception.code, code)
            self.assertNotRegex(str(raised.exception), r"Traceback|\.shearcell-|^shearcell:")
        with contextlib.redirect_stderr(io.StringIO()) as said, self.assertRaises(ShearcellError):
            shearcell.run({**self.QUESTION, "sede": 1})
        self.assertEqual(said.getvalue(), "", "the bar begins with the first progress")
        with self.assertRaisesRegex(ShearcellError, "sede") as raised:
            shearcell.plan({**self.QUESTION, "sede": 1})
        self.assertEqual(raised.exception.code, 2)
        with self.assertRaisesRegex(TypeError, "a path, a text or a dict"):
            shearcell.run([3])
        with self.assertRaisesRegex(TypeError, "cycels"):
            shearcell.run(self.QUESTION, cycels=3)
        with self.assertRaisesRegex(ValueError, "^seeds: nan"):
            shearcell.run({**self.QUESTION, "seeds": float("nan")})
        with self.assertRaisesRegex(ShearcellError, "no program /nowhere") as raised:
            shearcell.run(self.QUESTION, program="/nowhere")
        self.assertIsNone(raised.exception.code)

    def test_interrupt_stops_as_in_a_terminal(self):
        self.inside("interrupted")
        question = {**self.QUESTION, "base": {**self.QUESTION["base"], "steps_per_cycle": 200000}}
        expected = self.hashes(shearcell.run(question, store="whole").path)
        code = ("import json, shearcell, sys\n"
                "try:\n    shearcell.run(json.loads(sys.argv[1]), store=sys.argv[2])\n"
                "except KeyboardInterrupt:\n    sys.exit('KeyboardInterrupt')\n")
        for number in (signal.SIGINT, signal.SIGKILL):
            store = f"of-{number.name}"
            with subprocess.Popen([sys.executable, "-B", "-u", "-c", code, json.dumps(question), store],
                                  start_new_session=True, stderr=subprocess.PIPE, text=True) as python:
                said = ""
                while not re.search(r"fluid=\w+ seed=1: started", said):
                    more = python.stderr.read(1)
                    self.assertTrue(more, "it ended before it could be interrupted: " + said)
                    said += more
                children = pathlib.Path(f"/proc/{python.pid}/task/{python.pid}/children").read_text().split()
                self.assertEqual(len(children), 1)
                os.killpg(python.pid, number)  # as a terminal and Jupyter do
                said = python.stderr.read()
                python.wait()
            if number == signal.SIGINT:
                self.assertIn("KeyboardInterrupt", said)
            self.assertEqual([p.name for p in pathlib.Path().iterdir() if p.name.startswith(".")], [], "left behind")
            for _ in range(600):  # the program ends by itself
                if not pathlib.Path(f"/proc/{children[0]}/cmdline").is_file():
                    break
                time.sleep(0.1)
            states = {run.state for run in Store(store).runs()}
            # Without a reader the program may end at its next line, as if it had been killed.
            killed = {"running"} if number == signal.SIGKILL else set()
            self.assertLessEqual(states, {"interrupted", "declared", "completed"} | killed)
            self.assertNotEqual(states, {"completed"})
            self.assertEqual(self.hashes(shearcell.run(question, store=store).path), expected, "it continues")

    def test_figures_show_themselves(self):
        self.inside("shown")
        store = shearcell.run(self.QUESTION)
        figure = store.figure("compaction")
        self.assertEqual((figure.name, figure.experiment, figure.undrawn), ("compaction", "asked", []))
        self.assertTrue(all(file.is_file() for file in figure.files))
        self.assertIn("shearcell-figures/asked/base/compaction.csv", str(figure.files))
        self.assertTrue(figure._repr_svg_().startswith("<?xml"))
        page = figure._repr_html_()
        self.assertIn('<img src="data:image/svg+xml;base64,', page)
        self.assertIn(figure.caption.split("<")[0][:40], page)
        same = store.figure("same")
        self.assertIn(html.escape(same.facts["results"][0]), same._repr_html_())
        self.assertEqual([f.name for f in store.figures(fluid="cell", out="of cell")], ["compaction", "same"])
        shutil.rmtree("shearcell-figures")
        self.assertEqual(len(store.verdicts()), 1)
        self.assertFalse(pathlib.Path("shearcell-figures").exists())
        verdicts = store.verdicts(out="elsewhere")
        self.assertEqual(set(verdicts[["estimate", "low", "high", "margin", "runs_needed"]].dtypes), {np.dtype(float)})
        claim = json.loads(pathlib.Path("elsewhere/asked/base/same.verdict.json").read_text())["claims"][0]
        row = verdicts[verdicts["figure"] == "same"].iloc[0]
        self.assertEqual((row["verdict"], row["margin"], row["runs"]), (claim["verdict"], 0.005, claim["runs"]))
        facts = json.loads(json.dumps(figure.facts))
        facts["verdict"]["claims"] = [{**claim, "id": "A.1", "interval": [1, None]}]
        later = shearcell.Figure(facts).verdicts.iloc[0]
        self.assertEqual((later["id"], later["low"]), ("A.1", 1))
        self.assertIn("<!doctype html>", store.report("page.html").read_text(encoding="utf-8")[:20])
        with self.assertRaisesRegex(ShearcellError, "S2; to draw it anyway, add experiment=$") as raised:
            store.figure("S2")
        self.assertEqual(raised.exception.code, 2)
        self.addCleanup(os.environ.update, {"PATH": os.environ["PATH"]})
        os.environ["PATH"] = "/nowhere"
        with self.assertWarnsRegex(UserWarning, "gnuplot is not installed"):
            figure = store.figure("compaction", out="undrawn")
        self.assertIsNone(figure._repr_svg_())
        self.assertIn("gnuplot is not installed", figure._repr_html_())
        self.assertTrue(pathlib.Path("undrawn/asked/base/compaction.csv").is_file())

    def test_a_changed_function_is_said(self):
        store = Store(self.copy("changed"))
        scope = {}

        def define(text):
            exec(compile(text, "<cell>", "exec"), scope)
            return scope["own"]

        def said(function, key="own", **how):
            with warnings.catch_warnings(record=True) as all_said:
                warnings.simplefilter("always")
                values = list(store.measure(function, key=key, **how).iloc[:, -1])
            return values[1], [str(one.message) for one in all_said if "differs" in str(one.message)]

        self.assertEqual(said(define("def own(state): return 2 * state.cycle")), (2, []))
        # The same, written in another way and elsewhere.
        self.assertEqual(said(define("# what\n\ndef own(state):\n    return 2 * state.cycle  # twice")), (2, []))
        value, lines = said(define("def own(state): return 3 * state.cycle"))
        self.assertEqual((value, len(lines)), (2, 1))
        self.assertRegex(lines[0], "6 of these results were kept under the key own .*fresh=True")
        self.assertEqual(len(said(scope["own"], fluid="cell")[1]), 1)
        self.assertEqual(said(scope["own"], fresh=True), (3, []))
        self.assertEqual(said(scope["own"]), (3, []))
        # Whatever makes it compute something else.
        helped = "def own(state): return helper(state) + FACTOR\n"
        pairs = [(times(2), times(3)), (with_default(2), with_default(3)), (Scale(2), Scale(3)),
                 (Scale(2).method, Scale(3).method),
                 (functools.partial(multiplied, 2), functools.partial(multiplied, 3)),
                 (lambda state: np.sin(state.cycle), lambda state: np.cos(state.cycle)),
                 (lambda state: [1, 2][0], lambda state: [1, 3][0]),
                 (lambda state: (lambda: 1)(), lambda state: (lambda: 2)())]
        for n, (first, second) in enumerate(pairs):
            self.assertEqual(said(first, f"pair{n}")[1], [])
            self.assertEqual(said(first, f"pair{n}")[1], [])
            self.assertEqual(len(said(second, f"pair{n}")[1]), 1, n)
        define("def helper(state): return 1\nFACTOR = 1\n" + helped)
        said(scope["own"], "helped")
        for change in ("cycle = 7", "state = 1"):  # names that the function has for something else
            define(change + "\n" + helped)
            self.assertEqual(said(scope["own"], "helped")[1], [], change)
        for change in ("FACTOR = 2", "FACTOR = 1\ndef helper(state): return 2"):
            define(change + "\n" + helped)
            self.assertEqual(len(said(scope["own"], "helped")[1]), 1, change)
        # Files of an earlier version have no hash.
        file = self.folder / "changed.measures/own.json"
        kept = json.loads(file.read_text())
        for entry in kept["checkpoints"].values():
            del entry["function"]
        file.write_text(json.dumps(kept))
        self.assertEqual(said(define("def own(state): return 4 * state.cycle")), (3, []))

    def test_a_changed_value_changes_the_text_of_a_function(self):
        (self.folder / "own_module.py").write_text("def other(): return 1\ndef value(): return number\n")
        sys.path.insert(0, str(self.folder))
        self.addCleanup(sys.path.remove, str(self.folder))
        imports = "import dataclasses, functools, numpy, own_module, pandas, re\n"

        def defined(text):
            scope = {"__name__": "own_cell"}
            sys.modules["own_cell"] = types.ModuleType("own_cell")
            exec(compile(imports + text, "<cell>", "exec"), scope)
            return scope["own"]

        for text, result in (
                ("@dataclasses.dataclass\nclass P:\n  q: int = 0\nVALUE = P(NUMBER)", "VALUE.q"),
                ("class P:\n  q = NUMBER", "P.q"), ("class Q:\n  q = NUMBER\nclass P(Q): pass", "P.q"),
                ("class P:\n  @property\n  def q(self): return NUMBER", "P().q"),
                ("class P:\n  @staticmethod\n  def q(): return NUMBER", "P.q()"),
                ("VALUE = numpy.vectorize(lambda c: float(NUMBER), otypes=[float])", "VALUE(1)"),
                ("VALUE = pandas.DataFrame({'q': [1, NUMBER]})", "VALUE['q'].sum()"),
                ("VALUE = numpy.arange(NUMBER)", "VALUE.size"),
                ("VALUE = re.compile('a' * NUMBER)", "len(VALUE.pattern)"),
                ("@functools.lru_cache\ndef value(): return NUMBER", "value()"),
                ("own_module.number = NUMBER", "own_module.value()"),
                ("own_module.number = NUMBER\ndef value():\n  from own_module import value\n  return value()",
                 "value()")):
            with self.subTest(text):
                text += f"\ndef own(state): return {result}\n"
                own = defined(text.replace("NUMBER", "1"))
                first = _text_of(own, {})
                own(None)
                self.assertEqual(_text_of(own, {}), first, "after a call")
                self.assertEqual(_text_of(defined(text.replace("NUMBER", "1")), {}), first)
                self.assertNotEqual(_text_of(defined(text.replace("NUMBER", "2")), {}), first)
        own_module = sys.modules["own_module"]
        function = defined("def own(state): return own_module.value()")
        before = _text_of(function, {})
        own_module.other = own_module.value
        self.assertEqual(_text_of(function, {}), before, "it reads nothing else of the module")

    def test_a_measure_is_a_number_or_has_names(self):
        named = self.store.measure(lambda state: pandas.Series({"a": 1, "b": state.cycle}))
        self.assertEqual(list(named["b"]), [0, 1, 2] * 2)
        for result in (None, (1, 2), np.arange(5), pandas.Series, {"a": None}, "x"):
            with self.assertRaisesRegex(TypeError, "<lambda> must return a number or a mapping of names to numbers, not .*, "
                                                   "which it returned for cycle 0 of run [0-9a-f]{12}$"):
                self.store.measure(lambda state: result)

    def test_results_that_cannot_be_kept_are_returned(self):
        copy = self.copy("full")
        (self.folder / "full.measures").write_text("a file in the place of the folder")
        with self.assertWarnsRegex(UserWarning, "unknown are not kept"):
            self.assertEqual(len(Store(copy).measure(times(2), key="unknown")), 6)

    def test_errors_say_what_is_wrong(self):
        run = self.store.runs()[0]
        with self.assertRaisesRegex(KeyError, "the nearest checkpoints are at cycles"):
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
        copy = self.copy("damaged")
        file = copy / run.records()[-1]["file"]
        file.write_bytes(file.read_bytes()[:-1] + b"?")
        with self.assertRaisesRegex(ValueError, "is damaged"):
            Store(copy).run(run.id).checkpoint()

    def test_tour(self):
        notebook = json.loads(pathlib.Path(source, "experiments/python/tour.ipynb").read_text(encoding="utf-8"))
        code = [c["source"] for c in notebook["cells"] if c["cell_type"] == "code"]
        lines = [line for cell in code for line in cell if line.strip()]
        self.assertLess(len(lines), 40)
        if shutil.which("jupyter-nbconvert", path="/usr/bin") is None:
            self.skipTest("needs jupyter-nbconvert and python3-ipykernel")
        self.inside("tour")
        shutil.copy(f"{source}/experiments/python/tour.ipynb", "tour.ipynb")
        done = subprocess.run(["/usr/bin/jupyter-nbconvert", "--to", "notebook", "--execute", "tour.ipynb",
                               "--output", "executed.ipynb"], capture_output=True, text=True,
                              env={**os.environ, "MPLBACKEND": "agg"}, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("<svg", pathlib.Path("displacement.svg").read_text())
        shown = [output["data"].get("text/html", "") for cell in json.loads(pathlib.Path("executed.ipynb").read_text())["cells"]
                 for output in cell.get("outputs", []) if "data" in output]
        shown = ["".join(text) for text in shown]
        self.assertTrue(any("data:image/svg+xml" in text for text in shown), "no figure is shown")
        self.assertTrue(any("<td>agrees</td>" in text for text in shown), "no verdict is shown")
        self.assertTrue(pathlib.Path("tour.html").is_file())


if __name__ == "__main__":
    unittest.main(verbosity=2)
