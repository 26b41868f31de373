# SPDX-License-Identifier: GPL-3.0-or-later
"""Stores and runs, by the program's own commands."""
from __future__ import annotations

import functools
import json
import math
import numbers
import os
import re
import shutil
import subprocess
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterable, Iterator, Mapping, Union

from .checkpoint import Checkpoint

if TYPE_CHECKING:
    import pandas

Measure = Callable[[Checkpoint], Union[float, Mapping[str, float]]]


class ShearcellError(RuntimeError):
    """The program ended with an error; the text is its message."""


class Store:
    """A store, read only.

    Args:
        path: folder of the store. A relative path is of the working directory at this call.
        program: the program shearcell; default $SHEARCELL, or that in PATH.
    """

    def __init__(self, path: str | os.PathLike[str] = "shearcell-store",
                 program: str | os.PathLike[str] | None = None) -> None:
        self.path = Path(path).absolute()
        self._not_kept: set[str] = set()  # measures of which measure() has said so
        name = str(program or os.environ.get("SHEARCELL") or "shearcell")
        found = shutil.which(name)
        if found is None:
            raise ShearcellError(f"there is no program {name}: add its folder to PATH, or "
                                 "name it in $SHEARCELL")
        self.program = os.path.abspath(found)
        if not (self.path / "store.sqlite").is_file():
            raise FileNotFoundError(f"{self.path} is not a store")

    def call(self, *arguments: str | os.PathLike[str]) -> str:
        """Output of `shearcell ARGUMENTS --store PATH`. Raises ShearcellError."""
        # The program reads and writes UTF-8 whatever Python takes for the locale's encoding.
        given = [argument.encode("utf-8", "surrogateescape") if isinstance(argument, str)
                 else os.fsencode(argument) for argument in (*arguments, "--store", self.path)]
        done = subprocess.run([self.program, *given], capture_output=True, check=False)
        if done.returncode != 0:
            raise ShearcellError(done.stderr.decode(errors="replace").strip()
                                 or f"exit code {done.returncode}")
        return done.stdout.decode()

    def version(self) -> str:
        """The first line of `shearcell --version`."""
        done = subprocess.run([self.program, "--version"], capture_output=True, check=True)
        return done.stdout.decode().splitlines()[0]

    def runs(self, **select: Any) -> list["Run"]:
        """The runs of each manifest as it stands, in the order of their declaration, without the packings
        that they start from; a run of several experiments comes once for each.

        Args:
            select: experiment, scale, variant, seed, state or a swept parameter, such as
                amplitude_rad=0.05, each a value or a list of values. The program compares them,
                as with `--variant amplitude_rad=0.05`: numbers must be equal.
        """
        return [run for run in self._recorded(select) if run.facts["newest"]]

    def _recorded(self, select: Mapping[str, Any]) -> list["Run"]:
        """The same with the runs of older versions of manifests."""
        listed = json.loads(self.call("status", "--json", *_filters(select)))["runs"]
        return [Run(self, {**facts, **place})
                for facts in listed if facts["kind"] != "prepare" for place in facts["places"]]

    def run(self, prefix: str) -> "Run":
        """The run whose id begins with `prefix`. A run that several experiments share is that of the one which
        declared it last; `runs(experiment=...)` gives it as another's. Raises KeyError if it is none
        or several."""
        found = {run.id: run for run in self._recorded({}) if run.id.startswith(prefix)}
        if len(found) != 1:
            raise KeyError(f"{len(found)} runs begin with {prefix!r}")
        return next(iter(found.values()))

    def table(self, per: str = "checkpoint", curve: str = "", **select: Any) -> "pandas.DataFrame":
        """`shearcell table`: a row for each checkpoint, or for each run (per="run"), or for each
        value of a curve at each checkpoint (curve="pair_correlation"); needs pandas.

        Columns have their unit in the name; `shearcell table --help` lists them and the curves.
        Text stays text, even "NA", "007" or "1e3"; what is unknown or does not apply is missing.

        Args:
            per: "checkpoint" or "run".
            curve: name of a curve, or "".
            select: experiment, scale, variant, seed or a swept parameter, as for runs().
        """
        import pandas

        if curve and per != "checkpoint":
            raise ValueError("a curve has a row for each value at each checkpoint; leave out `per`")
        rows = ("--curve", curve) if curve else ("--per", per)
        asked = ("table", *rows, *_filters(select))
        found = json.loads(self.call(*asked, "--json"))["rows"]
        if not found:
            return pandas.DataFrame(columns=self.call(*asked).splitlines()[0].split(","))
        table = pandas.DataFrame(found)
        empty = [name for name in table if table[name].isna().all()]
        return table.astype(dict.fromkeys(empty, float))

    def measure(self, function: Measure, *, key: str | None = None, fresh: bool = False,
                **select: Any) -> "pandas.DataFrame":
        """A measure of your own: the rows and columns of table(), and what the function returns
        for each checkpoint; needs pandas.

        A number goes into a column named as the key, or else as the function; a mapping into one
        column for each of its names. They are missing where the checkpoint's file is pruned.

        With a key, results are kept beside the store, in PATH.measures/KEY.json: a checkpoint is
        computed once, and its results stay when its file is pruned. The key is your promise that
        the function is always the same and depends on the checkpoint alone. Nothing of the
        function is compared: after a change to the function, its arguments or what it reads, use
        another key or fresh=True. Results by another build of the program are computed again.
        Results that are not finite are not kept, since an earlier checkpoint that they need may
        come back.

        Args:
            function: from a Checkpoint to a number, or to a mapping of names to numbers.
            key: name of the measure: letters, digits and _ . + = -
            fresh: computes every stored checkpoint again.
            select: experiment, scale, variant, seed, state or a swept parameter, as for runs().
        """
        import pandas

        name = key or _name_of(function)
        if key is None and name not in self._not_kept:
            self._not_kept.add(name)
            warnings.warn(f"the results of {name} are not kept: every call computes them again. "
                          "measure(function, key=...) keeps them under a name of yours",
                          stacklevel=2)
        kept = _Kept(self, key)
        select = {what: _texts(values) for what, values in select.items()}
        table = self.table(**{what: value for what, value in select.items() if what != "state"})
        runs: dict[tuple[str, str, str], list[Run]] = {}
        for run in self._recorded(select):
            runs.setdefault((run.experiment, run.scale, run.id), []).append(run)
        places = list(zip(table["experiment"], table["scale"], table["run"]))
        if "state" in select:
            chosen = [n for n, place in enumerate(places) if place in runs]
            table, places = table.iloc[chosen].reset_index(drop=True), [places[n] for n in chosen]
        results = []
        try:
            for place, variant, sha256 in zip(places, table["variant"], table["checkpoint"]):
                run = next((run for run in runs[place] if run.facts["name"] == variant),
                           runs[place][0])
                record = run._by_sha256[sha256]
                stored = record["state"] == "recorded"
                found = None if fresh and stored else kept.get(sha256, stored)
                if found is None and stored:
                    result = function(Checkpoint(run, record))
                    named = result if isinstance(result, Mapping) else {name: result}
                    found = {str(column): float(value) for column, value in named.items()}
                    if taken := set(found).intersection(table.columns):
                        raise ValueError(f"the table has a column {min(taken)} already; "
                                         "give the measure another name")
                    kept.add(sha256, found)
                results.append(found or {})
        finally:
            kept.save()
        own = pandas.DataFrame(results, index=table.index, dtype=float)
        return table.join(own if len(own.columns) > 0 else own.assign(**{name: math.nan}))

    def __repr__(self) -> str:
        return f"Store({str(self.path)!r})"


class Run:
    """One run: a variant with a seed, as a part of one experiment.

    Several experiments may share a run and ask for different checkpoints of it. `cycles`,
    `checkpoints()` and the newest `checkpoint()` are those of `experiment`, as in `Store.table`;
    `records()` has all.

    Attributes:
        store, id, experiment, scale, variant, seed, state: as `shearcell status` has them.
        facts: everything that `shearcell status --json` says.
    """

    def __init__(self, store: Store, facts: dict[str, Any]) -> None:
        self.store = store
        self.facts = facts
        self.id: str = facts["id"]
        self.experiment: str = facts["experiment"]
        self.scale: str = facts["scale"]
        self.variant: str = facts["variant"]
        self.seed: int = facts["seed"]
        self.state: str = facts["state"]

    @functools.cached_property
    def _shown(self) -> dict[str, Any]:
        return json.loads(self.store.call("show", self.id, "--json"))

    @functools.cached_property
    def _place(self) -> int:
        """Of its experiment in the run's memberships."""
        keys = ("experiment", "scale", "variant", "seed", "manifest")
        places = [[m[key] for key in keys] for m in self._shown["memberships"]]
        return places.index([self.facts[key] for key in keys])

    @property
    def parameters(self) -> dict[str, Any]:
        """Every parameter that affects the run, by its key in a manifest (units are in the keys)."""
        return self._shown["parameters"]

    def records(self) -> list[dict[str, Any]]:
        """What the store recorded of each checkpoint whose file it has, by cycle. `asked_by` is
        empty for those that no experiment has in its figures."""
        return [c for c in self._shown["checkpoints"] if c["state"] == "recorded"]

    @functools.cached_property
    def _by_sha256(self) -> dict[str, dict[str, Any]]:
        return {c["sha256"]: c for c in self._shown["checkpoints"] if c["state"] != "rejected"}

    def _of_experiment(self) -> list[dict[str, Any]]:
        return [record for record in self.records() if self._place in record["asked_by"]]

    @property
    def cycles(self) -> list[float]:
        """Cycles at which the experiment has a checkpoint whose file is stored."""
        return [record["cycle"] for record in self._of_experiment()]

    def checkpoint(self, cycle: float | None = None) -> Checkpoint:
        """The checkpoint at that cycle, which may be any of `records()`, or the newest of `cycles`.
        A cycle is found to within 1e-6, but never that of another time step. Raises KeyError if
        there is none."""
        if cycle is None:
            if not self._of_experiment():
                raise KeyError(f"run {self.id[:12]} has no stored checkpoint of {self.experiment}")
            return Checkpoint(self, self._of_experiment()[-1])
        if not isinstance(cycle, numbers.Real):
            raise TypeError(f"a cycle is a number, not {cycle!r}")
        known = sorted(self._by_sha256.values(), key=lambda c: abs(c["cycle"] - cycle))
        step = min((c["cycle"] / c["step"] for c in known if c["step"] > 0), default=1)  # [cycles]
        found = [c for c in known if abs(c["cycle"] - cycle) <= min(1e-6, step / 2)][:1]
        if found and found[0]["state"] == "recorded":
            return Checkpoint(self, found[0])
        if found:
            raise KeyError(f"the checkpoint of run {self.id[:12]} at cycle {cycle:g} was pruned; "
                           f"`shearcell regenerate {found[0]['sha256'][:12]}` brings it back")
        near = sorted(c["cycle"] for c in [c for c in known if c["state"] == "recorded"][:3])
        raise KeyError(f"run {self.id[:12]} has no checkpoint at cycle {cycle:.12g}; nearest to "
                       f"it, it has those of cycles {', '.join(f'{c:.12g}' for c in near)}")

    def checkpoints(self) -> Iterator[Checkpoint]:
        """The checkpoints at `cycles`, read one after the other."""
        return (Checkpoint(self, record) for record in self._of_experiment())

    def __repr__(self) -> str:
        return f"<Run {self.id[:12]} {self.experiment} {self.variant} seed {self.seed}>"


class _Kept:
    """Results under a user's key, in a file beside the store. Without a key nothing is kept."""

    def __init__(self, store: Store, key: str | None) -> None:
        fits = isinstance(key, str) and re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.+=-]{0,99}", key)
        if key is not None and not fits:
            raise ValueError(f"{key!r} cannot be a key: a key has at most 100 letters, digits and "
                             "_ . + = - and begins with a letter, a digit or _")
        self.key = key
        self.known: dict[str, dict[str, Any]] = {}  # by checkpoint: `program` and `results`
        self.new: dict[str, dict[str, Any]] = {}
        if key is not None:
            folder = store.path.resolve()
            self.file = folder.with_name(folder.name + ".measures") / f"{key}.json"
            self.program = store.version()
            self.known = self._read()

    def _read(self) -> dict[str, dict[str, Any]]:
        try:
            entries = json.loads(self.file.read_text(encoding="utf-8"))["checkpoints"]
            # Files of earlier versions have other entries, maybe of another function.
            return {sha256: entry for sha256, entry in entries.items() if "program" in entry}
        except (FileNotFoundError, NotADirectoryError):
            return {}
        except (ValueError, LookupError, AttributeError) as problem:
            raise ValueError(f"{self.file} is damaged; delete it or choose another key") from problem

    def get(self, sha256: str, stored: bool) -> dict[str, float] | None:
        """Results by this build of the program; where nothing is stored, those of any build."""
        entry = self.known.get(sha256)
        known = entry is not None and (entry["program"] == self.program or not stored)
        return entry["results"] if known else None

    def add(self, sha256: str, results: dict[str, float]) -> None:
        if self.key is not None:
            self.new[sha256] = {"program": self.program, "results": results}

    def save(self) -> None:
        if not self.new:
            return
        # Another process may have added results. A measure over two checkpoints is not a number
        # where the earlier one is missing, which may come back.
        entries = {sha256: entry for sha256, entry in {**self._read(), **self.new}.items()
                   if all(map(math.isfinite, entry["results"].values()))}
        part = self.file.with_suffix(f".{os.getpid()}.tmp")
        try:
            self.file.parent.mkdir(exist_ok=True)
            part.write_text(json.dumps({"key": self.key, "checkpoints": entries}, indent=1) + "\n",
                            encoding="utf-8")
            part.replace(self.file)
        except OSError as problem:
            warnings.warn(f"the results of {self.key} are not kept: {problem}", stacklevel=3)


def _name_of(function: Measure) -> str:
    """As pandas names it."""
    while isinstance(function, functools.partial):
        function = function.func
    return getattr(function, "__name__", type(function).__name__)


def _texts(values: Any) -> list[str]:
    several = isinstance(values, Iterable) and not isinstance(values, str)
    return [str(value) for value in values] if several else [str(values)]


def _filters(select: Mapping[str, Any]) -> list[str]:
    arguments = []
    for key, values in select.items():
        chosen = _texts(values)
        if not chosen:
            raise ValueError(f"{key}: no value is given; leave it out to select all")
        for value in chosen:
            if key in ("experiment", "scale", "variant", "seed", "state"):
                arguments += [f"--{key}", value]
            else:
                arguments += ["--variant", f"{key}={value}"]
    return arguments
