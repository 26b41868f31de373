# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes wheels of the package with the standard library alone: for pip (pyproject.toml), and with the program inside
for experiments/install/archive.py. Equal files give equal bytes. Nothing is written into the clone."""
import base64
import contextlib
import hashlib
import os
import re
import sys
import time
import zipfile
from pathlib import Path

here = Path(__file__).resolve().parent
sys.dont_write_bytecode = True
if __spec__ is not None and __spec__.cached:  # pip has written it into the clone
    Path(__spec__.cached).unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        Path(__spec__.cached).parent.rmdir()

METADATA = """Metadata-Version: 2.1
Name: shearcell
Version: {version}
Summary: Runs discrete element experiments on cyclically sheared grains and reads their stores
License: GPL-3.0-or-later
Requires-Python: >=3.9
Provides-Extra: tables
Requires-Dist: numpy; extra == "tables"
Requires-Dist: h5py; extra == "tables"
Requires-Dist: pandas; extra == "tables"
Provides-Extra: ase
Requires-Dist: ase; extra == "ase"
"""


def version_of_clone():
    """The version is that of the program."""
    try:
        text = (here.parents[1] / "CMakeLists.txt").read_text(encoding="utf-8")
        return re.search(r"project\(shearcell VERSION ([\d.]+)", text)[1]
    except (OSError, TypeError, IndexError):
        sys.exit(f"{here} is a copy of experiments/python, and its version stands in the clone that it comes from. Install "
                 "from that clone (pip install CLONE/experiments/python), or install the wheel, which has the program too "
                 "(sh experiments/install/archive.sh OUT in the clone makes it)")


def write(folder, version, seconds=None, inside=None, package=None):
    """Writes the wheel into the folder and returns its name. `inside`: files by their place in the wheel, with which it
    has the program; `package`: files of the package as texts, instead of the package here."""
    tag = "py3-none-manylinux_2_17_x86_64" if inside else "py3-none-any"
    name, about = f"shearcell-{version}-{tag}.whl", f"shearcell-{version}.dist-info"
    seconds = int(os.environ.get("SOURCE_DATE_EPOCH", 315532800)) if seconds is None else seconds
    entries = package or {f"shearcell/{file.name}": file for file in sorted((here / "shearcell").glob("*.py"))}
    entries = {**entries, **(inside or {})}
    entries[f"{about}/METADATA"] = METADATA.format(version=version)
    pure = "false" if inside else "true"
    entries[f"{about}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: shearcell\nRoot-Is-Purelib: {pure}\nTag: {tag}\n"
    if inside:
        entries[f"{about}/entry_points.txt"] = "[console_scripts]\nshearcell = shearcell.__main__:main\n"
    record = ""
    with zipfile.ZipFile(os.path.join(folder, name), "w", zipfile.ZIP_DEFLATED) as wheel:
        def add(place, content, mode):
            entry = zipfile.ZipInfo(place, time.gmtime(max(seconds, 315532800))[:6])
            entry.external_attr, entry.compress_type = (0o100000 | mode) << 16, zipfile.ZIP_DEFLATED
            wheel.writestr(entry, content)

        for place, source in entries.items():
            runs = isinstance(source, Path) and os.access(source, os.X_OK)
            content = source.read_bytes() if isinstance(source, Path) else source.encode()
            add(place, content, 0o755 if runs else 0o644)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record += f"{place},sha256={digest},{len(content)}\n"
        add(f"{about}/RECORD", record + f"{about}/RECORD,,\n", 0o644)
    return name


# What pip calls (PEP 517, PEP 660). `pip install -e` gets a path to the sources.
def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    return write(wheel_directory, version_of_clone())


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    return write(wheel_directory, version_of_clone(), package={"shearcell.pth": f"{here}\n"})


def build_sdist(sdist_directory, config_settings=None):
    sys.exit("a source distribution of experiments/python alone cannot be installed; make a wheel")
