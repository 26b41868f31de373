# SPDX-License-Identifier: GPL-3.0-or-later
"""The program shearcell: where it is, its errors, and a campaign with a progress bar."""
from __future__ import annotations

import contextlib
import ctypes
import importlib
import json
import math
import os
import re
import reprlib
import shutil
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterable, Iterator, Union

if TYPE_CHECKING:
    import pandas

    from .store import Store

PathLike = Union[str, "os.PathLike[str]"]
Manifest = Union[PathLike, Mapping[str, Any]]


class ShearcellError(RuntimeError):
    """The program ended with an error; the text is its message.

    Attributes:
        code: its exit code: 1 the machine failed, 2 usage or manifest, 3 a run failed numerically, 4 the
            store is damaged, 85 interrupted. 128 + N if signal N ended it. None if there is no program.
    """

    def __init__(self, message: str, code: int | None = None) -> None:
        super().__init__(message)
        self.code = code

    def __reduce__(self) -> Any:
        return type(self), (str(self), self.code)


def need(*modules: str) -> Any:
    """Imports the modules and returns the first one. Raises ImportError that says how to install a missing module."""
    for name in reversed(modules):
        try:
            found = importlib.import_module(name)
        except ImportError:
            raise ImportError(f"this needs the Python package {name}: pip install {name}, or Debian's "
                              f"package python3-{name}", name=name) from None
    return found


def find_program(program: PathLike | None = None) -> str:
    """Path of the program: `program` if given, else $SHEARCELL, else the program in the wheel, else in PATH."""
    own = Path(__file__).with_name("program") / "shearcell"
    name = os.path.expanduser(program or os.environ.get("SHEARCELL") or (own if own.is_file() else "shearcell"))
    found = shutil.which(name)
    if found is None:
        raise ShearcellError(f"there is no program {name}: add its folder to PATH, or name it in $SHEARCELL")
    return os.path.abspath(found)


def full_path(path: PathLike) -> Path:
    """The absolute path; `~` is the home folder."""
    return Path(os.path.expanduser(path)).absolute()


def call(program: str, *arguments: PathLike, made: Iterable[int] = ()) -> subprocess.CompletedProcess[bytes]:
    """Runs the program to its end, whatever its exit code. `made`: files that _files() made."""
    return subprocess.run([program, *map(_encoded, arguments)], capture_output=True, check=False, pass_fds=[*made])


def output_of(program: str, *arguments: PathLike, translate: Callable[[str], str] = str,
              accept: tuple[int, ...] = (0,)) -> str:
    """Output of the program. Raises ShearcellError if its exit code is not one of `accept`; `translate` is applied to
    the message."""
    done = call(program, *arguments)
    if done.returncode not in accept:
        raise error_of(done.returncode, done.stderr.decode(errors="replace").splitlines(), translate)
    return done.stdout.decode()


def error_of(code: int, lines: Iterable[str], translate: Callable[[str], str]) -> ShearcellError:
    """The exception for an exit code and the lines on standard error. `translate` is applied to its message."""
    text = "\n".join(line[11:] if line.startswith("shearcell: ") else line for line in lines
                     if not line.startswith(("warning: ", "Run with --help", "Interrupted. ")))
    text = translate(text)
    if code < 0:
        code, text = 128 - code, text or f"{signal.Signals(-code).name} ended the program"
    if code == 85:
        text = text or "the program was interrupted; the same call continues"
    return ShearcellError(text.strip() or f"exit code {code}", code)


def options(**given: Any) -> list[str]:
    """--NAME VALUE for each option that is not None, several times for a list; a bare --NAME for True."""
    words = []
    for name, values in given.items():
        option = "--" + name.replace("_", "-")
        several = isinstance(values, Iterable) and not isinstance(values, (str, os.PathLike))
        for value in values if several else [values]:
            if value is True:
                words.append(option)
            elif value is not None and value is not False:
                words += [option, str(whole(value))]
    return words


def whole(value: Any) -> Any:
    """The int that equals a float; any other value as it is. The program takes an int for every number."""
    real = hasattr(value, "is_integer") and not isinstance(value, int)
    return int(value) if real and value.is_integer() and abs(value) < 2**53 else value


def run(manifest: Manifest | Iterable[Manifest], scale: str | None = None,
        store: PathLike = "shearcell-store", jobs: int | None = None, *, cycles: int | None = None,
        seeds: int | None = None, seed: Any = None, variant: Any = None, engine: str | None = None,
        threads: int | None = None, mpi: int | None = None, keep_every: int | None = None,
        quiet: bool = False, program: PathLike | None = None) -> "Store":
    """Computes the runs of manifests that the store does not have, and returns the store.

    Shows a progress bar of tqdm if tqdm is installed, else lines of text. On Ctrl-C ("interrupt" in a notebook)
    the program writes checkpoints, and KeyboardInterrupt is raised. The same call continues the runs, bit for bit.
    A second Ctrl-C ends the program at once; nothing that is recorded is lost.

    Args:
        manifest: path of a manifest, its text (with a line break or ": "), or its content as a dict; or a list of
            these. In a text or a dict, a relative path in `start: {file: ...}` is relative to the working directory.
        scale: named size (default: desk).
        store: folder of the store, or a Store.
        jobs: runs at a time (default: one per core).
        cycles, seeds, seed, variant, engine, threads, mpi, keep_every, quiet: as the options of `shearcell run`, such
            as cycles=20, seeds=3, seed="4-6", threads=2, keep_every=10, variant=["fluid=cell"].
        program: the program shearcell; default as for Store.

    Raises:
        ShearcellError: with the message and the exit code of the program; code 3 if a run failed
            numerically, after all other runs were computed.
    """
    from .store import Store

    found, folder = find_program(program), _folder(store)
    with _files(manifest) as (files, made):
        given = options(scale=scale, jobs=jobs, cycles=cycles, seeds=seeds, seed=seed, variant=variant, engine=engine,
                        threads=threads, mpi=mpi, keep_every=keep_every, quiet=quiet)
        _compute(found, ["run", *files, *given, "--json", "--store", folder], made)
    return Store(folder, program)


def plan(manifest: Manifest | Iterable[Manifest], scale: str | None = None,
         store: PathLike = "shearcell-store", jobs: int | None = None, *, cycles: int | None = None,
         seeds: int | None = None, seed: Any = None, variant: Any = None, engine: str | None = None,
         threads: int | None = None, mpi: int | None = None, keep_every: int | None = None,
         quiet: bool = False, program: PathLike | None = None) -> "pandas.DataFrame":
    """What `run` with these arguments would compute, and its cost: a row for each stage; needs pandas.

    `core_seconds_left` is estimated from the speed of earlier runs in the store. If there are none, a speed is
    assumed, and `attrs["rate_measured"]` is false. `attrs` of the DataFrame also has the sums: `seconds_left` on
    `cores` cores, `bytes_left`, `runs`, `notes` and the other facts of `shearcell plan --json`. `jobs`, `threads`,
    `mpi`, `keep_every` and `quiet` have no effect.
    """
    del jobs, threads, mpi, keep_every, quiet
    pandas = need("pandas")
    found = find_program(program)
    with _files(manifest) as (files, made):
        given = options(scale=scale, cycles=cycles, seeds=seeds, seed=seed, variant=variant, engine=engine)
        done = call(found, "plan", *files, *given, "--json", "--store", _folder(store), made=made)
    if done.returncode != 0:
        raise error_of(done.returncode, done.stderr.decode(errors="replace").splitlines(),
                       lambda text: in_python(text, made))
    facts = json.loads(done.stdout)
    facts["warnings"] = [in_python(warning, made) for warning in facts["warnings"]]
    for warning in facts["warnings"]:
        warnings.warn(warning, stacklevel=2)
    rate = facts["particle_steps_per_second_and_core"]
    first = ("experiment", "stage", "variant", "seed", "N", "cycles", "state")
    frame = pandas.DataFrame([{**{key: stage[key] for key in first},
                               "core_seconds_left": stage["particle_steps_left"] / rate,
                               **{key: value for key, value in stage.items() if not isinstance(value, dict)}}
                              for stage in facts.pop("stages")])
    frame.attrs.update(facts)
    return frame


def in_python(text: str, made: Mapping[int, bool] | None = None) -> str:
    """A message of the program in the words of this package: keywords in place of options, and "manifest" in place of
    files that _files() made. Lines and columns in the JSON of a dict are left out."""
    for file, of_dict in (made or {}).items():
        text = re.sub(rf"/dev/fd/{file}\b" + r"(:\d+:\d+)?" * of_dict, "manifest", text)
    names = "cycles|engine|experiment|jobs|keep-every|mpi|out|scale|seeds?|state|store|threads|variant"
    # Commands between backticks stay commands.
    return re.sub(rf"`\w[^`]*`|--({names})\b(:?)",
                  lambda found: found[1].replace("-", "_") + (found[2] or "=") if found[1] else found[0], text)


def _encoded(argument: PathLike) -> bytes:
    # The program reads and writes UTF-8 whatever Python takes for the locale's encoding.
    if isinstance(argument, str):
        return argument.encode("utf-8", "surrogateescape")
    return os.fsencode(argument)


def _folder(store: Any) -> Path:
    return full_path(getattr(store, "path", store))


@contextlib.contextmanager
def _files(manifest: Manifest | Iterable[Manifest]) -> Iterator[tuple[list[PathLike], dict[int, bool]]]:
    """Yields the paths of all manifests, and the files that were made from texts and dicts: by descriptor, whether it
    is of a dict. These files are in memory and have no name, so that none is left when Python is killed."""
    several = isinstance(manifest, Iterable) and not isinstance(manifest, (str, bytes, os.PathLike, Mapping))
    paths: list[PathLike] = []
    made: dict[int, bool] = {}
    with contextlib.ExitStack() as opened:
        for one in manifest if several else [manifest]:
            if isinstance(one, Mapping):
                text = json.dumps(_plain(one, ""), indent=1, ensure_ascii=False) + "\n"
            elif isinstance(one, str) and ("\n" in one or (
                    re.search(r"^\s*\{|: ", one) and not os.path.exists(os.path.expanduser(one)))):
                text = one
            elif isinstance(one, (str, os.PathLike)) and one != "":
                paths.append(os.path.expanduser(one))
                continue
            else:
                raise TypeError(f"a manifest is a path, a text or a dict, not {reprlib.repr(one)}")
            file = opened.enter_context(open(os.memfd_create("manifest"), "w", encoding="utf-8"))
            file.write(text)
            file.flush()
            made[file.fileno()] = isinstance(one, Mapping)
            paths.append(f"/dev/fd/{file.fileno()}")
        if not paths:
            raise TypeError("a manifest is a path, a text or a dict, or a list of these; this list is empty")
        yield paths, made


def _plain(value: Any, key: str) -> Any:
    """The value of a manifest's key for JSON: numbers and arrays of numpy, paths, and other collections."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {name: _plain(each, f"{key}.{name}".lstrip(".")) for name, each in value.items()}
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"{key}: {value} is not a finite number")
        return whole(value)
    if value is None or isinstance(value, (str, int)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Iterable) and not isinstance(value, bytes):
        return [_plain(each, f"{key}[{n}]") for n, each in enumerate(value)]
    raise TypeError(f"{key}: {reprlib.repr(value)} cannot be a value of a manifest")


class _Bar:
    """Progress of a campaign in stages: a bar of tqdm, or a line of text, which a terminal overwrites. It begins with
    the first line of progress; warnings come before that line."""

    def __init__(self) -> None:
        self.running: dict[str, float] = {}  # completed fraction of each running stage
        self.done, self.total, self.shown = 0, 0, 0
        self.tqdm: Any = None

    def _begin(self) -> None:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                from tqdm.auto import tqdm
                self.tqdm = tqdm(total=None, unit="stage", bar_format="{percentage:3.0f}%|{bar}| {desc}")
        except ImportError:
            pass

    def read(self, line: str) -> bool:
        """Takes a line of the program's progress; returns whether it is one."""
        if ended := re.fullmatch(r"(.*): (.*) \((\d+) of (\d+) stages done\)", line):
            name, how = ended[1], ended[2]
            if self.total == 0:
                self._begin()
            self.done, self.total = int(ended[3]), int(ended[4])
            self.running.pop(name, None)
            if how == "started":
                self.running[name] = 0
            text = f"{name}: {how}"
        elif now := re.fullmatch(r"(.*): (cycle ([\d.]+) of (\d+)|step \d+) .*", line):
            if now[3] and float(now[4]) > 0:
                self.running[now[1]] = min(1.0, float(now[3]) / float(now[4]))
            text = re.sub(" +", " ", line)
        else:
            return False
        done = self.done + sum(self.running.values())
        if self.tqdm is not None:
            self.tqdm.total, self.tqdm.n = self.total, round(done, 2)
            self.tqdm.set_description_str(f"{self.done} of {self.total} stages; {text}", refresh=False)
            self.tqdm.refresh()
            return True
        text = f"{100 * done / max(1, self.total):3.0f} %, {self.done} of {self.total} stages; {text}"
        over = sys.stderr is not None and sys.stderr.isatty()
        print(text.ljust(self.shown) if over else text, end="\r" if over else "\n", file=sys.stderr, flush=True)
        self.shown = len(text) if over else 0
        return True

    def say(self, line: str) -> None:
        if self.tqdm is not None:
            self.tqdm.write(line, file=sys.stderr)
        else:
            print(line.ljust(self.shown), file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.tqdm is not None:
            self.tqdm.close()
        elif self.shown > 0:
            print(file=sys.stderr)


def _end_with_parent() -> None:
    """Runs in the child, so that the program gets SIGTERM when Python is killed, and writes checkpoints."""
    _prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG


_prctl = ctypes.CDLL(None).prctl


def _compute(program: str, words: list[PathLike], made: Mapping[int, bool]) -> None:
    """Runs `shearcell run` and shows its progress. The program has its own session, because a terminal or a notebook
    sends SIGINT to a whole process group, and a second SIGINT would end the program without checkpoints."""
    lines: list[str] = []
    bar = _Bar()
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen([program, *map(_encoded, words)], stdin=subprocess.DEVNULL, stdout=output,
                                   stderr=subprocess.PIPE, start_new_session=True, preexec_fn=_end_with_parent,
                                   pass_fds=[*made])
        stopped = None
        while True:
            try:
                for line in process.stderr:
                    line = in_python(line.decode(errors="replace").rstrip("\n"), made)
                    if bar.read(line):
                        continue
                    lines.append(line)
                    if line.startswith("warning: "):
                        warnings.warn(line[9:], stacklevel=3)
                    elif bar.total > 0 and not line.startswith("Interrupted. "):  # else the exception says it
                        bar.say(line)
                process.stderr.close()
                process.wait()
                break
            except KeyboardInterrupt as stop:
                stopped = stop
                process.send_signal(signal.SIGINT)
                bar.say("interrupted: the program writes checkpoints; the same call continues")
            except BaseException:
                process.send_signal(signal.SIGINT)
                process.wait()
                raise
        bar.close()
        output.seek(0)
        said = output.read().decode(errors="replace")
    if stopped is not None:
        raise stopped
    if process.returncode != 0:
        with contextlib.suppress(ValueError, LookupError):
            lines = json.loads(said)["messages"] or lines
        raise error_of(process.returncode, lines, lambda text: in_python(text, made))
