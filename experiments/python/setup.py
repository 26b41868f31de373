# SPDX-License-Identifier: GPL-3.0-or-later
"""The version is that of the program, from CMakeLists.txt; pyproject.toml has everything else."""
import pathlib
import re

import setuptools

root = pathlib.Path(__file__).resolve().parents[2]
project = (root / "CMakeLists.txt").read_text(encoding="utf-8")
setuptools.setup(version=re.search(r"project\(shearcell VERSION ([\d.]+)", project)[1])
