# SPDX-License-Identifier: GPL-3.0-or-later
"""Stores and runs, by the program's own commands."""
from __future__ import annotations

import hashlib
import inspect
import io
import json
import math
import numbers
import os
import shutil
import subprocess
import textwrap
import warnings
from functools import cached_property
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
        path: folder of the store.
        program: the program shearcell; default $SHEARCELL, or that in PATH.
    """

    def __init__(self, path: str | os.PathLike[str] = "shearcell-store",
                 program: str | os.PathLike[str] | None = None) -> None:
        self.path = Path(path)
        self.program = str(program or os.environ.get("SHEARCELL") or "shearcell")
        if shutil.which(self.program) is None:
            raise ShearcellError(f"there is no program {self.program}: add its folder to PATH, or "
                                 "name it in $SHEARCELL")
        if not (self.path / "store.sqlite").is_file():
            raise FileNotFoundError(f"{self.path} is not a store")

    def call(self, *arguments: str) -> str:
        """Output of `shearcell ARGUMENTS --store PATH`. Raises ShearcellError."""
        done = subprocess.run([self.program, *arguments, "--store", str(self.path)],
                              capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise ShearcellError(done.stderr.strip() or f"exit code {done.returncode}")
        return done.stdout

    def version(self) -> str:
        """The first line of `shearcell --version`."""
        done = subprocess.run([self.program, "--version"], capture_output=True, text=True, check=True)
        return done.stdout.splitlines()[0]

    def runs(self, *, all_versions: bool = False, **select: Any) -> list["Run"]:
        """Runs in the order of their declaration, without the packings that they start from; a run
        of several experiments comes once for each.

        Args:
            all_versions: those of older versions of a manifest too, as `shearcell table` has them.
            select: experiment, scale, variant, seed or state, each a value or a list of values.
        """
        listed = json.loads(self.call("status", "--json", *_filters(select)))["runs"]
        return [Run(self, {**facts, **place})
                for facts in listed if facts["kind"] != "prepare"
                for place in facts["places"] if all_versions or place["newest"]]

    def run(self, prefix: str) -> "Run":
        """The run whose id begins with `prefix`. A run that several experiments share is that of the one which
        declared it last; `runs(experiment=...)` gives it as another's. Raises KeyError if it is none
        or several."""
        found = {run.id: run for run in self.runs(all_versions=True) if run.id.startswith(prefix)}
        if len(found) != 1:
            raise KeyError(f"{len(found)} runs begin with {prefix!r}")
        return next(iter(found.values()))

    def table(self, per: str = "checkpoint", curve: str = "", *, all_versions: bool = False,
              **select: Any) -> "pandas.DataFrame":
        """`shearcell table`: a row for each checkpoint, or for each run (per="run"), or for each
        value of a curve at each checkpoint (curve="pair_correlation"); needs pandas.

        Columns have their unit in the name; `shearcell table --help` lists them and the curves.

        Args:
            per: "checkpoint" or "run".
            curve: name of a curve, or "".
            all_versions: runs of older versions of a manifest too, with a column `manifest`.
            select: experiment, scale, variant or seed, each a value or a list of values.
        """
        import pandas

        if curve and per != "checkpoint":
            raise ValueError("a curve has a row for each value at each checkpoint; leave out `per`")
        rows = ("--curve", curve) if curve else ("--per", per)
        more = ("--all-versions",) if all_versions else ()
        text = self.call("table", *rows, *more, *_filters(select))
        return pandas.read_csv(io.StringIO(text), float_precision="round_trip")

    def measure(self, function: Measure, *, fresh: bool = False, all_versions: bool = False,
                **select: Any) -> "pandas.DataFrame":
        """A measure of your own for every checkpoint that figures and tables use: experiment, scale,
        variant, run, seed, cycle, checkpoint and what the function returns, in a column of its name
        or one for each key; needs pandas.

        Results are kept beside the store, in PATH.measures/NAME.json, with the SHA-256 of the
        function's source, that of each checkpoint and the program's version, and are computed
        again when one of these changes; results that are not finite are not kept. Only the
        function's own source is looked at: after a change in a function that it calls, use
        fresh=True.

        Args:
            function: from a Checkpoint to a number, or to a mapping of names to numbers.
            fresh: computes everything again.
            all_versions: of runs of older versions of a manifest too.
            select: experiment, scale, variant, seed or state, each a value or a list of values.
        """
        import pandas

        kept = _KeptMeasure(self, function, fresh)
        rows = []
        try:
            for run in self.runs(all_versions=all_versions, **select):
                for record in run._of_experiment():
                    result = kept.of(record["sha256"], lambda: Checkpoint(run, record))
                    rows.append({"experiment": run.experiment, "scale": run.scale,
                                 "variant": run.facts["name"], "run": run.id, "seed": run.seed,
                                 "cycle": record["cycle"], "checkpoint": record["sha256"],
                                 **result})
        finally:
            kept.save()
        return pandas.DataFrame(rows)

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
        self.scale: str = facts["scale"] or "base"
        self.variant: str = facts["variant"]
        self.seed: int = facts["seed"]
        self.state: str = facts["state"]

    @cached_property
    def _shown(self) -> dict[str, Any]:
        return json.loads(self.store.call("show", self.id, "--json"))

    @cached_property
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

    def _of_experiment(self) -> list[dict[str, Any]]:
        return [record for record in self.records() if self._place in record["asked_by"]]

    @property
    def cycles(self) -> list[float]:
        """Cycles at which the experiment has a checkpoint whose file is stored."""
        return [record["cycle"] for record in self._of_experiment()]

    def checkpoint(self, cycle: float | None = None) -> Checkpoint:
        """The checkpoint at that cycle, which may be any of `records()`, or the newest of `cycles`.
        Raises KeyError if there is none."""
        if cycle is not None and not isinstance(cycle, numbers.Real):
            raise TypeError(f"a cycle is a number, not {cycle!r}")
        found = (self._of_experiment() if cycle is None
                 else [c for c in self.records() if c["cycle"] == cycle])
        if found:
            return Checkpoint(self, found[-1])
        pruned = [c["sha256"][:12] for c in self._shown["checkpoints"]
                  if c["state"] == "pruned" and c["cycle"] == cycle]
        if pruned:
            raise KeyError(f"the checkpoint of run {self.id[:12]} at cycle {cycle:g} was pruned; "
                           f"`shearcell regenerate {pruned[-1]}` brings it back")
        which = "" if cycle is None else f" at cycle {cycle:g}"
        raise KeyError(f"run {self.id[:12]} has no checkpoint{which}; it has those of cycles "
                       f"{self.cycles}")

    def checkpoints(self) -> Iterator[Checkpoint]:
        """The checkpoints at `cycles`, read one after the other."""
        return (Checkpoint(self, record) for record in self._of_experiment())

    def __repr__(self) -> str:
        return f"<Run {self.id[:12]} {self.experiment} {self.variant} seed {self.seed}>"


class _KeptMeasure:
    """Results of one function, in a file beside the store."""

    def __init__(self, store: Store, function: Measure, fresh: bool) -> None:
        self.function = function
        self.fresh = fresh
        self.name: str = function.__name__
        try:
            source = textwrap.dedent(inspect.getsource(function))
        except (OSError, TypeError) as problem:
            raise ValueError(f"the source of {self.name} is not known; define it in a file or a "
                             "notebook's cell") from problem
        if not self.name.isidentifier():
            raise ValueError(f"{self.name} cannot name a measure; define a function with `def`")
        self.facts: dict[str, Any] = {
            "measure": self.name, "source": source,
            "source_sha256": hashlib.sha256(source.encode()).hexdigest(),
            "program": store.version()}
        folder = store.path.resolve()
        self.file = folder.with_name(folder.name + ".measures") / f"{self.name}.json"
        self.values: dict[str, dict[str, float]] = {}
        if self.file.is_file():
            known = json.loads(self.file.read_text())
            if all(known.get(key) == self.facts[key] for key in ("source_sha256", "program")):
                self.values = known["checkpoints"]
        self.done: set[str] = set()
        self.changed = False

    def of(self, sha256: str, load: Callable[[], Checkpoint]) -> dict[str, float]:
        if sha256 in self.values and (not self.fresh or sha256 in self.done):
            return self.values[sha256]
        result = self.function(load())
        named = result if isinstance(result, Mapping) else {self.name: result}
        found = {str(key): float(value) for key, value in named.items()}
        # A measure over two checkpoints is not a number where the earlier one is missing, which
        # may be made later.
        self.values.pop(sha256, None)
        if all(math.isfinite(value) for value in found.values()):
            self.values[sha256] = found
        self.done.add(sha256)
        self.changed = True
        return found

    def save(self) -> None:
        if not self.changed:
            return
        part = self.file.with_suffix(f".{os.getpid()}.tmp")
        try:
            self.file.parent.mkdir(exist_ok=True)
            part.write_text(json.dumps({**self.facts, "checkpoints": self.values}, indent=1) + "\n")
            part.replace(self.file)
        except OSError as problem:
            warnings.warn(f"the results of {self.name} are not kept: {problem}", stacklevel=3)


def _filters(select: Mapping[str, Any]) -> list[str]:
    arguments = []
    known = ("experiment", "scale", "variant", "seed", "state")
    for key, values in select.items():
        if key not in known:
            raise TypeError(f"runs are not selected by {key}, but by {', '.join(known)}")
        several = isinstance(values, Iterable) and not isinstance(values, str)
        chosen = [str(value) for value in values] if several else [str(values)]
        if not chosen:
            raise ValueError(f"{key}: no value is given; leave it out to select all")
        for value in chosen:
            arguments += [f"--{key}", value]
    return arguments
