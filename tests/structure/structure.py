# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the structure of the sources: python3 structure.py REPOSITORY
Includes follow the table below, no file includes itself through others, and the tables of files and folders in each
README name what is there."""

import pathlib
import re
import sys

# Each folder (with the folders in it that have no entry of their own) and what it may include besides itself.
BELOW = {
    "core": [],
    "protocols": ["core"],
    "provenance/io": [],
    "provenance": ["core/bits_version.hpp", "core/cell.hpp", "core/machine.hpp", "core/named.hpp", "core/scene.hpp", "core/state.hpp", "provenance/io"],
    "analysis": ["core", "provenance", "provenance/io"],
    "experiments/manifest": ["analysis", "core", "protocols", "provenance", "provenance/io"],
}
BELOW["experiments/runner"] = ["experiments/manifest", *BELOW["experiments/manifest"]]
BELOW["experiments/figures"] = ["experiments/runner", *BELOW["experiments/runner"]]
BELOW["experiments/report"] = ["experiments/figures", *BELOW["experiments/figures"]]
for folder in ("bench", "cluster", "export"):
    BELOW[f"experiments/{folder}"] = BELOW["experiments/report"]
BELOW["experiments/cli"] = ["experiments/bench", "experiments/cluster", "experiments/export", "experiments/report",
                            *BELOW["experiments/report"]]
TOP = ("core", "protocols", "provenance", "analysis", "experiments", "tests")
GENERATED = {"experiments/manifest/shipped_texts.hpp", "experiments/manifest/tried_names.hpp",
             "experiments/runner/build_facts.hpp"}  # by CMake


def group(path):
    folders = [folder for folder in BELOW if path.startswith(folder + "/")]
    return max(folders, key=len, default=None)


def cycle(file, includes, path, done):
    """The files of a cycle through this one, or nothing."""
    if file in path:
        return path[path.index(file):] + [file]
    if file not in done:
        for other in includes.get(file, []):
            if found := cycle(other, includes, path + [file], done):
                return found
        done.add(file)
    return None


def named_in_tables(readme):
    """(line, name) of each file or folder in the first column of tables with such a heading."""
    heading = ""
    for number, line in enumerate(readme.read_text().splitlines(), 1):
        first = line.split("|")[1].strip() if line.startswith("|") else ""
        heading = (heading or first) if first else ""
        if heading in ("file", "files", "folder") and first != heading:
            yield from ((number, name.strip("/")) for name in re.findall(r"`([\w./-]+)`", first))


root = pathlib.Path(sys.argv[1])
faults, includes = [], {}
for top in TOP:
    for file in sorted(root.joinpath(top).rglob("*.[ch]pp")):
        name = str(file.relative_to(root))
        if "node_modules" in name:
            continue
        lines = file.read_text().splitlines()
        own = group(name)
        if own is None and top != "tests":
            faults.append(f"{name}: its folder has no entry in {pathlib.Path(__file__).name}")
        includes[name] = []
        for number, line in enumerate(lines, 1):
            match = re.match(r'\s*#\s*include "([^"]+)"', line)
            if not match:
                continue
            other = match[1]
            includes[name].append(other)
            if other not in GENERATED and not (root / other).exists():
                faults.append(f"{name}:{number}: includes {other}, which does not exist; name it from the repository's root")
            elif own and group(other) != own and not {group(other), other} & set(BELOW[own]):
                faults.append(f"{name}:{number}: {own} may not include {other}")
for readme in [root / "README.md", *(page for top in TOP for page in sorted((root / top).rglob("README.md")))]:
    if "node_modules" in readme.parts:
        continue
    there = {name for file in readme.parent.glob("*") for name in (file.name, file.stem)}
    for number, name in named_in_tables(readme):
        if name not in there and not (readme.parent / name).exists():
            faults.append(f"{readme.relative_to(root)}:{number}: there is no {name}")
done = set()
for file in includes:
    if found := cycle(file, includes, [], done):
        faults.append("includes itself: " + " -> ".join(found))
        break
print("\n".join(faults) or f"{len(includes)} files, nothing wrong")
sys.exit(1 if faults else 0)
