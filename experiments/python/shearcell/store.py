# SPDX-License-Identifier: GPL-3.0-or-later
"""Stores and runs. The commands of the program read them."""
from __future__ import annotations

import copyreg
import dis
import functools
import hashlib
import importlib
import json
import math
import numbers
import os
import re
import reprlib
import sys
import tempfile
import types
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterable, Iterator, Mapping, Union

from .figures import Figure, Figures, verdicts_of
from .program import call, error_of, find_program, full_path, in_python, need, options, output_of, whole

if TYPE_CHECKING:
    import pandas

    from .checkpoint import Checkpoint

Measure = Callable[["Checkpoint"], Union[float, Mapping[str, float]]]


def checkpoint_class() -> type["Checkpoint"]:
    need("numpy", "h5py")
    from .checkpoint import Checkpoint

    return Checkpoint


class Store:
    """A store. `figures`, `figure` and `verdicts` record in it what they have drawn, as `shearcell figures` does. Other
    methods write nothing but measures into its cache, `derived.sqlite`.

    Args:
        path: folder of the store. A relative path is relative to the working directory at this call.
        program: the program shearcell (default: $SHEARCELL, else the program in this package's wheel, else in PATH).
    """

    def __init__(self, path: str | os.PathLike[str] = "shearcell-store",
                 program: str | os.PathLike[str] | None = None) -> None:
        self.path = full_path(path)
        self._not_kept: set[str] = set()  # measures without a key, of which measure() has warned
        self.program = find_program(program)
        if not (self.path / "store.sqlite").is_file():
            raise FileNotFoundError(f"{self.path} is not a store")

    def call(self, *arguments: str | os.PathLike[str]) -> str:
        """Output of `shearcell ARGUMENTS --store PATH`. Raises ShearcellError."""
        return output_of(self.program, *arguments, "--store", self.path)

    def _output(self, *arguments: str | os.PathLike[str]) -> str:
        """As call(), with errors in the words of this package."""
        return output_of(self.program, *arguments, "--store", self.path, translate=in_python)

    def version(self) -> str:
        """The first line of `shearcell --version`."""
        return output_of(self.program, "--version").splitlines()[0]

    def runs(self, **select: Any) -> list["Run"]:
        """The runs of the newest version of each manifest, in the order of their declaration, without the stages
        that settle packings. A run that several experiments share is listed once for each of them.

        Args:
            select: experiment, scale, variant, seed, state or a swept parameter, such as
                amplitude_rad=0.05, each a value or a list of values. The program compares them,
                as with `--variant amplitude_rad=0.05`: numbers must be equal.
        """
        return [run for run in self._recorded(select) if run.facts["newest"]]

    def _recorded(self, select: Mapping[str, Any]) -> list["Run"]:
        """As runs(), with the runs of older versions of manifests."""
        listed = json.loads(self._output("status", "--json", *_filters(select)))["runs"]
        return [Run(self, {**facts, **place})
                for facts in listed if facts["kind"] != "prepare" for place in facts["places"]]

    def run(self, prefix: str) -> "Run":
        """The run whose id begins with `prefix`. If several experiments share the run, `experiment` is the one that
        declared it last; `runs(experiment=...)` gives it as a run of another experiment. Raises KeyError if no
        id, or more than one, begins with `prefix`."""
        found = {run.id: run for run in self._recorded({}) if run.id.startswith(prefix)}
        if len(found) != 1:
            raise KeyError(f"{len(found)} runs begin with {prefix!r}")
        return next(iter(found.values()))

    def table(self, per: str = "checkpoint", curve: str = "", **select: Any) -> "pandas.DataFrame":
        """`shearcell table`: a row for each checkpoint, or for each run (per="run"), or for each
        value of a curve at each checkpoint (curve="pair_correlation"); needs pandas.

        Names of columns end in the unit; `shearcell table --help` lists the columns and the curves. Text stays
        text, even "NA", "007" or "1e3". A value that is unknown or does not apply is missing.

        Args:
            per: "checkpoint" or "run".
            curve: name of a curve, or "".
            select: experiment, scale, variant, seed or a swept parameter, as for runs().
        """
        pandas = need("pandas")
        if curve and per != "checkpoint":
            raise ValueError("a curve has a row for each value at each checkpoint; leave out `per`")
        rows = ("--curve", curve) if curve else ("--per", per)
        asked = ("table", *rows, *_filters(select))
        found = json.loads(self._output(*asked, "--json"))["rows"]
        if not found:
            return pandas.DataFrame(columns=self.call(*asked).splitlines()[0].split(","))
        table = pandas.DataFrame(found)
        empty = [name for name in table if table[name].isna().all()]
        return table.astype(dict.fromkeys(empty, float))

    def measure(self, function: Measure, *, key: str | None = None, fresh: bool = False,
                **select: Any) -> "pandas.DataFrame":
        """A measure of your own: the rows and columns of table(), and the results of the function for each
        checkpoint; needs pandas.

        If the function returns a number, its column has the name of the key, or of the function if there is no
        key. If it returns a mapping or a pandas Series, each of its names is a column. Where the file of the
        checkpoint is pruned, the result is missing.

        With a key, results are kept beside the store, in PATH.measures/KEY.json: a checkpoint is
        computed once, and its results stay when its file is pruned. The key is your promise that
        the function is always the same and depends on the checkpoint alone: after a change use
        another key or fresh=True. A hash of the function is kept beside its results, and a warning
        says if it has changed since: its code, its defaults, and the values, functions, classes and modules
        that it reads. Functions and classes of Python and of installed packages are compared by name, files
        that the function opens are not compared, and nothing is compared after a change of Python's version.
        Results of another build of the program are computed again.
        Results that are not finite are not kept: they may need an earlier checkpoint, whose file may be
        restored.

        Args:
            function: from a Checkpoint to a number, or to a mapping of names to numbers.
            key: name of the measure: letters, digits and _ . + = -
            fresh: computes every stored checkpoint again.
            select: experiment, scale, variant, seed, state or a swept parameter, as for runs().
        """
        pandas = need("pandas")
        name = key or _name_of(function)
        if key is None and name not in self._not_kept:
            self._not_kept.add(name)
            warnings.warn(f"the results of {name} are not kept: every call computes them again. "
                          "measure(function, key=...) keeps them under a name of yours",
                          stacklevel=2)
        kept = _Kept(self, key, function)
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
                    result = function(checkpoint_class()(run, record))
                    named = result if isinstance(result, (Mapping, pandas.Series)) else {name: result}
                    try:
                        found = {str(column): float(value) for column, value in named.items()}
                    except (TypeError, ValueError):
                        raise TypeError(f"{_name_of(function)} must return a number or a mapping of names to numbers, "
                                        f"not {reprlib.repr(result)}, which it returned for cycle {record['cycle']:g} "
                                        f"of run {run.id[:12]}") from None
                    if taken := set(found).intersection(table.columns):
                        raise ValueError(f"the table has a column {min(taken)} already; "
                                         "give the measure another name")
                    kept.add(sha256, found)
                results.append(found or {})
        finally:
            kept.save()
        if kept.changed > 0:
            warnings.warn(f"{kept.changed} of these results were kept under the key {key} by a function that differs "
                          f"from {_name_of(function)} now. measure(..., fresh=True) computes them again, and another "
                          "key keeps both", stacklevel=2)
        own = pandas.DataFrame(results, index=table.index, dtype=float)
        return table.join(own if len(own.columns) > 0 else own.assign(**{name: math.nan}))

    def figures(self, *names: str, out: str | os.PathLike[str] = "shearcell-figures", wide: bool = False,
                **select: Any) -> Figures:
        """Draws figures into OUT/EXPERIMENT/SCALE, as `shearcell figures` does: the figures in `names`, or all
        figures that the store's manifests list. A notebook shows them. Without gnuplot, a warning says that the
        drawings are missing; numbers and verdicts are written.

        Args:
            names: such as "S2".
            out: folder to write to.
            wide: drawings as wide as two columns of a journal.
            select: experiment, scale, variant, seed or a swept parameter, as for runs(); one scale.
        """
        done = call(self.program, "figures", *names, "--out", full_path(out),
                    *options(width="double" if wide else None), *_filters(select), "--json", "--store", self.path)
        lines = done.stderr.decode(errors="replace").splitlines()
        try:
            found = Figures(map(Figure, json.loads(done.stdout)["figures"]))
        except ValueError:
            raise error_of(done.returncode, lines, in_python) from None
        undrawn = [why for figure in found for why in figure.undrawn]
        if done.returncode not in ((0, 1) if undrawn else (0,)):
            raise error_of(done.returncode, lines, in_python)
        for why in dict.fromkeys([*undrawn, *(line[9:] for line in lines if line.startswith("warning: "))]):
            warnings.warn(in_python(why), stacklevel=2)
        return found

    def figure(self, name: str, **how: Any) -> Figure:
        """One figure; arguments as for figures(). Raises ValueError if several experiments list it."""
        found = self.figures(name, **how)
        if len(found) != 1:
            raise ValueError(f"{len(found)} experiments list {name}: "
                             f"{', '.join(figure.experiment for figure in found)}; name one with experiment=")
        return found[0]

    def verdicts(self, *names: str, **how: Any) -> "pandas.DataFrame":
        """The verdicts of figures: a row for each claim, with the ends of its interval as `low` and
        `high`; arguments as for figures(); needs pandas. The figures are deleted again if `out` is not given."""
        need("pandas")
        with tempfile.TemporaryDirectory(prefix="shearcell-python-") as folder:
            return verdicts_of(self.figures(*names, **{"out": folder, **how}))

    def report(self, path: str | os.PathLike[str] = "report.html", **select: Any) -> Path:
        """Writes the interactive page of `shearcell report`, and returns its path. `select` as for
        runs(), without `state`."""
        self._output("report", "--out", full_path(path), *_filters(select))
        return full_path(path)

    def __repr__(self) -> str:
        return f"Store({str(self.path)!r})"


class Run:
    """One run: a variant with a seed, as a part of one experiment.

    Several experiments may share a run and ask for different checkpoints of it. `cycles`, `checkpoints()` and the
    newest `checkpoint()` are the ones that `experiment` asks for, as in `Store.table`; `records()` has all.

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
        # Code 4: a file is damaged. The other files can still be read.
        return json.loads(output_of(self.store.program, "show", self.id, "--json", "--store", self.store.path,
                                    accept=(0, 4)))

    @functools.cached_property
    def _place(self) -> int:
        """Index of the run's experiment in `memberships` of `shearcell show`."""
        keys = ("experiment", "scale", "variant", "seed", "manifest")
        places = [[m[key] for key in keys] for m in self._shown["memberships"]]
        return places.index([self.facts[key] for key in keys])

    @property
    def parameters(self) -> dict[str, Any]:
        """Every parameter that affects the run, by its key in a manifest (units are in the keys)."""
        return self._shown["parameters"]

    def records(self) -> list[dict[str, Any]]:
        """The record of each checkpoint whose file is stored, by cycle. `asked_by` is empty for a checkpoint that
        no experiment shows in its figures."""
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

    def checkpoint(self, cycle: float | None = None) -> "Checkpoint":
        """The checkpoint of `records()` at this cycle, or without a cycle the newest one of `cycles`. The cycle may
        differ by 1e-6, but by less than half a time step. Raises KeyError if there is no such checkpoint."""
        if cycle is None:
            if not self._of_experiment():
                raise KeyError(f"run {self.id[:12]} has no stored checkpoint of {self.experiment}")
            return checkpoint_class()(self, self._of_experiment()[-1])
        if not isinstance(cycle, numbers.Real):
            raise TypeError(f"a cycle is a number, not {cycle!r}")
        known = sorted(self._by_sha256.values(), key=lambda c: abs(c["cycle"] - cycle))
        step = min((c["cycle"] / c["step"] for c in known if c["step"] > 0), default=1)  # [cycles]
        found = [c for c in known if abs(c["cycle"] - cycle) <= min(1e-6, step / 2)][:1]
        if found and found[0]["state"] == "recorded":
            return checkpoint_class()(self, found[0])
        if found:
            raise KeyError(f"the checkpoint of run {self.id[:12]} at cycle {cycle:g} was pruned; "
                           f"`shearcell regenerate {found[0]['sha256'][:12]}` restores it")
        near = sorted(c["cycle"] for c in [c for c in known if c["state"] == "recorded"][:3])
        raise KeyError(f"run {self.id[:12]} has no checkpoint at cycle {cycle:.12g}; the nearest "
                       f"checkpoints are at cycles {', '.join(f'{c:.12g}' for c in near)}")

    def checkpoints(self) -> Iterator["Checkpoint"]:
        """The checkpoints at `cycles`, read one after the other."""
        return (checkpoint_class()(self, record) for record in self._of_experiment())

    def __repr__(self) -> str:
        return f"<Run {self.id[:12]} {self.experiment} {self.variant} seed {self.seed}>"


class _Kept:
    """Results under a user's key, in a file beside the store. Without a key nothing is kept."""

    def __init__(self, store: Store, key: str | None, function: Measure) -> None:
        fits = isinstance(key, str) and re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.+=-]{0,99}", key)
        if key is not None and not fits:
            raise ValueError(f"{key!r} cannot be a key: a key has at most 100 letters, digits and "
                             "_ . + = - and begins with a letter, a digit or _")
        self.key = key
        self.known: dict[str, dict[str, Any]] = {}  # by checkpoint: `program`, `function` and `results`
        self.new: dict[str, dict[str, Any]] = {}
        self.changed = 0  # number of results from get() that a different function computed
        if key is not None:
            folder = store.path.resolve()
            self.file = folder.with_name(folder.name + ".measures") / f"{key}.json"
            self.program = store.version()
            # The version of Python is part of the text, because the code's bytes depend on it.
            text = _text_of(function, {})
            python = f"{sys.version_info[0]}.{sys.version_info[1]}/2"  # 2: version of _text_of
            self.function = f"{python} {hashlib.sha256(text.encode()).hexdigest()}"
            self.known = self._read()

    def _read(self) -> dict[str, dict[str, Any]]:
        try:
            entries = json.loads(self.file.read_text(encoding="utf-8"))["checkpoints"]
            # Entries of earlier versions lack `program`; a different function may have computed them.
            return {sha256: entry for sha256, entry in entries.items() if "program" in entry}
        except (FileNotFoundError, NotADirectoryError):
            return {}
        except (ValueError, LookupError, AttributeError) as problem:
            raise ValueError(f"{self.file} is damaged; delete it or choose another key") from problem

    def get(self, sha256: str, stored: bool) -> dict[str, float] | None:
        """The kept results for a checkpoint: of this build of the program, or of any build if the file of the
        checkpoint is not stored."""
        entry = self.known.get(sha256)
        if entry is None or (entry["program"] != self.program and stored):
            return None
        python, _, before = entry.get("function", "").partition(" ")
        now = self.function.split(" ")
        self.changed += python == now[0] and before != now[1]
        return entry["results"]

    def add(self, sha256: str, results: dict[str, float]) -> None:
        if self.key is not None:
            self.new[sha256] = {"program": self.program, "function": self.function, "results": results}

    def save(self) -> None:
        if not self.new:
            return
        # The file is read again, because another process may have added results. Results that are not finite are
        # left out: they may need an earlier checkpoint, whose file may be restored.
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
    """The name of the function, as pandas gives it."""
    while isinstance(function, functools.partial):
        function = function.func
    return getattr(function, "__name__", type(function).__name__)


def _text_of(value: Any, seen: dict[int, tuple[int, Any]]) -> str:
    """A text that is equal for two functions that compute the same: their code, without line numbers and documentation,
    and the values that they read. Other values have the text of their content; what is of a library, and what has no
    content that can be read, has its name. `seen`: by id, the number of each value, and the value to keep its id."""
    if value is None or isinstance(value, (bool, int, float, complex, str, bytes, type(...))):
        return repr(value)
    kind = type(value)
    if kind.__module__.startswith(f"{__package__}."):  # a Store, Run or Checkpoint
        return repr(value)
    if id(value) in seen:
        return f"<{seen[id(value)][0]}>"
    if kind not in (tuple, frozenset):  # equal ones may be one object or several
        seen[id(value)] = len(seen), value
    parts: Any
    if isinstance(value, types.CodeType):
        parts = (value.co_code, value.co_names, value.co_varnames, value.co_argcount, value.co_consts)
    elif isinstance(value, types.ModuleType):
        return f"module {value.__name__}"
    elif isinstance(value, (types.FunctionType, type)) and _is_of_library(value):
        return f"{value.__module__} {value.__qualname__}"
    elif isinstance(value, types.FunctionType):
        code = value.__code__
        # The documentation is a constant of the code.
        parts = (code.replace(co_consts=tuple(None if each is value.__doc__ else each for each in code.co_consts)),
                 value.__defaults__, value.__kwdefaults__,
                 [cell.cell_contents for cell in value.__closure__ or () if cell != types.CellType()],
                 _read_by(code, value.__globals__))
    elif isinstance(value, type):
        parts = (value.__bases__, {name: each for name, each in vars(value).items()
                                   if isinstance(each, types.FunctionType) or not name.startswith("__")})
    elif kind in (set, frozenset):
        parts = sorted(_text_of(part, seen) for part in value)
    elif kind is dict:
        parts = [part for pair in value.items() for part in pair]
    elif kind in (tuple, list):
        parts = value
    else:
        parts = _state_of(value)
    try:
        return f"{kind.__name__}({', '.join([_text_of(part, seen) for part in parts])})"
    except RecursionError:
        return kind.__name__


def _state_of(value: Any) -> list[Any]:
    """What pickle writes of an object. Of an object of a library that wraps functions, the functions: pickle cannot
    write a property or a static method, and it writes caches of others."""
    if _is_of_library(type(value)) and not isinstance(value, (types.MethodType, functools.partial)):
        inner = [getattr(value, name) for name in ("__wrapped__", "__func__", "fget", "pyfunc", "py_func")
                 if name in vars(type(value)) or name in getattr(value, "__dict__", ())]
        if inner:  # functools.cache, staticmethod, property, numpy.vectorize, numba.jit
            return inner
    try:
        reduce = copyreg.dispatch_table.get(type(value))
        reduced = reduce(value) if reduce else value.__reduce_ex__(4)
    except Exception:  # each class has its own
        reduced = getattr(value, "__name__", "")
    parts = [type(value), *([reduced] if isinstance(reduced, str) else reduced)]
    return [list(part) if isinstance(part, Iterator) else part for part in parts]


# Files of Python and of packages, this one included.
_LIBRARY = re.compile(f"^({re.escape(os.path.dirname(os.__file__))}|{re.escape(os.path.dirname(__file__))})/"
                      "|/(site|dist)-packages/")


def _is_of_library(value: Any) -> bool:
    """Whether a function, a class or a module is of Python or of an installed package."""
    home = value if isinstance(value, types.ModuleType) else sys.modules.get(value.__module__)
    file = value.__code__.co_filename if isinstance(value, types.FunctionType) else getattr(home, "__file__", None)
    return getattr(home, "__name__", "") in sys.builtin_module_names or bool(_LIBRARY.search(file or ""))


def _read_by(code: types.CodeType, scope: Mapping[str, Any]) -> list[Any]:
    """The values that the code, with the functions inside it, reads from its module and from other modules that are
    not of a library. Modules that the code imports count."""
    codes = [code]
    for each in codes:
        codes += [inner for inner in each.co_consts if isinstance(inner, types.CodeType)]
    steps = [step for each in codes for step in dis.get_instructions(each)]
    read = [scope.get(step.argval) for step in steps if step.opname in ("LOAD_GLOBAL", "LOAD_NAME")]
    read += [_module(step.argval) for step in steps if step.opname == "IMPORT_NAME"]
    names = {name: None for each in codes for name in each.co_names}
    modules = []
    for each in read:
        if isinstance(each, types.ModuleType) and each not in modules and not _is_of_library(each):
            modules.append(each)
            read += [vars(each)[name] for name in names if name in vars(each)]
    return read


def _module(name: str) -> types.ModuleType | None:
    try:
        return importlib.import_module(name)
    except Exception:  # the code may handle this, and a module may raise anything
        return None


def _texts(values: Any) -> list[str]:
    several = isinstance(values, Iterable) and not isinstance(values, str)
    return [str(whole(value)) for value in (values if several else [values])]


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
