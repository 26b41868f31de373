#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the blocks marked `sh` of a Markdown file, in order, in a folder of their own.

    python3 snippets.py FILE PROGRAM_FOLDER SOURCE_FOLDER

The folder holds the project's experiments/ as a link, and PROGRAM_FOLDER comes first in PATH. Stops
with code 1 at the first block that fails, and prints its line and its output.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

file, programs, source = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
text = file.read_text()
blocks = list(re.finditer(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL))
if not blocks:
    sys.exit(f"{file} has no block marked sh")
environment = dict(os.environ, PATH=f"{programs}:{os.environ['PATH']}")
environment.pop("SHEARCELL_STORE", None)

with tempfile.TemporaryDirectory() as folder:
    os.symlink(source / "experiments", pathlib.Path(folder) / "experiments")
    for block in blocks:
        line = text.count("\n", 0, block.start()) + 1
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", block.group(1)],
            cwd=folder,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        if done.returncode != 0:
            sys.exit(f"{file}:{line}: code {done.returncode}\n{block.group(1)}\n{done.stdout}")
print(f"{file.name}: {len(blocks)} blocks ran")
