# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the installed program, its libraries and their licences as archive and wheel, for archive.sh:
   python3 archive.py WORK BUILD OUT     WORK has the launcher `shearcell` and the folder `installed`"""
import calendar
import json
import lzma
import os
import re
import shutil
import subprocess
import sys
import tarfile
import time
from pathlib import Path

work, build, out = map(Path, sys.argv[1:])
source = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(source / "experiments/python"))
import backend  # noqa: E402

# HDF5 reads files from the web with libcurl, which needs 25 more libraries. The program reads no such file, so a library
# of that name whose functions return 0 takes its place.
LEFT_OUT = "libcurl.so.4"


def said(*words):
    return subprocess.run(words, stdout=subprocess.PIPE, check=True, text=True).stdout


def needed(file):
    return re.findall(r"NEEDED +(\S+)", said("objdump", "-p", file))


def collect_libraries(program, folder):
    """Copies the libraries that the program needs, without those that LEFT_OUT alone needs, and the loader."""
    folder.mkdir()
    shutil.copy(program, folder / "program")
    found = dict(re.findall(r"(\S+) => (/\S+)", said("ldd", program)))
    wanted, users = needed(program), []
    for name in wanted:  # grows
        if name == LEFT_OUT or (folder / name).exists():
            continue
        file = Path("/lib64", name) if name.startswith("ld-linux") else Path(found[name])
        shutil.copyfile(file, folder / name)
        more = needed(file)
        wanted += more
        if LEFT_OUT in more:
            users.append(file)
    if users:
        names = sorted(set(re.findall(r" U (curl_\w+)@(\w+)", "".join(said("nm", "-D", file) for file in users))))
        assert names and len({version for _, version in names}) == 1, names
        (work / "stub.c").write_text("".join(f"long {name}(void) {{ return 0; }}\n" for name, _ in names))
        (work / "stub.map").write_text(f"{names[0][1]} {{ global: *; }};\n")
        subprocess.run(["gcc", "-O2", "-shared", "-nostdlib", "-fPIC", "-s", f"-Wl,-soname,{LEFT_OUT}",
                        "-Wl,--build-id=none", f"-Wl,--version-script={work}/stub.map", "-o", folder / LEFT_OUT,
                        work / "stub.c"], check=True)
    return {file.name for file in folder.iterdir()} - {"program", LEFT_OUT}


def write_licences(bill, libraries, folder):
    """The bill of materials without what is left out, a table of the sources, and every licence."""
    folder.mkdir()
    listed = {}
    for part in bill["components"]:
        files = [file["name"] for file in part.get("components", [])]
        if not files or libraries.intersection(files):
            listed[part["name"]] = part
            libraries -= set(files)
    if libraries:
        sys.exit(f"the bill of materials lacks {', '.join(sorted(libraries))}")
    bill["components"] = list(listed.values())
    (folder / "shearcell.cdx.json").write_text(json.dumps(bill, indent=2) + "\n")
    rows, common = [], set()
    for name, part in listed.items():
        if part.get("purl", "").startswith("pkg:npm/"):
            rows.append((name, part["version"], f"npm {name}", part["version"]))
            continue
        if not part.get("purl"):
            sys.exit(f"{name} is of no Debian package: its licence and source are unknown")
        facts = said("dpkg-query", "-W", "-f", "${source:Package} ${source:Version}\n", name).split("\n")[0].split(" ")
        rows.append((name, part["version"], *facts))
        text = Path(f"/usr/share/doc/{name}/copyright").read_text(encoding="utf-8", errors="replace")
        (folder / name).write_text(text, encoding="utf-8")
        common.update(re.findall(r"/usr/share/common-licenses/([A-Za-z0-9.-]*[A-Za-z0-9])", text))
    for name in sorted(common):
        shutil.copyfile(f"/usr/share/common-licenses/{name}", folder / f"common-{name}")
    shutil.copy(build / "experiments/report/web/bundle/licences.txt", folder / "npm")
    shutil.copy(source / "LICENSE", folder / "shearcell")
    rows = [("package", "version", "source", "version of the source"), *sorted(rows)]
    widths = [max(map(len, column)) for column in zip(*rows)]
    (folder / "sources.txt").write_text(
        "What `shearcell` holds. Debian's packages are unchanged; libcurl.so.4 is a stub without a function of curl.\n"
        "`debsnap SOURCE VERSION` (Debian package devscripts) fetches the source of a Debian package, and `npm pack\n"
        "PACKAGE@VERSION` an npm package. The file PACKAGE beside this one has its licence; common-LICENCE has the text\n"
        "of a licence that Debian names /usr/share/common-licenses/LICENCE.\n\n"
        + "".join("  ".join(map(str.ljust, row, widths)).rstrip() + "\n" for row in rows))


def write_archive(folder, seconds, file):
    """Equal files give equal bytes: sorted, owned by root, with the time of the commit."""
    # Higher presets save a tenth of the size and take five times as long.
    filters = [{"id": lzma.FILTER_X86}, {"id": lzma.FILTER_LZMA2, "preset": 1}]
    with lzma.open(file, "wb", filters=filters) as packed, \
            tarfile.open(fileobj=packed, mode="w", format=tarfile.USTAR_FORMAT) as archive:
        for path in [folder, *sorted(folder.rglob("*"))]:
            entry = archive.gettarinfo(path, str(path.relative_to(folder.parent)))
            entry.uid, entry.gid, entry.uname, entry.gname, entry.mtime = 0, 0, "root", "root", seconds
            entry.mode = 0o755 if path.is_dir() or os.access(path, os.X_OK) else 0o644
            with open(path, "rb") if path.is_file() else open(os.devnull, "rb") as content:
                archive.addfile(entry, content)


installed = work / "installed"
bill = json.loads((installed / "share/shearcell/shearcell.cdx.json").read_text())
version = bill["metadata"]["component"]["version"]
when = bill["metadata"].get("timestamp", "1980-01-01T00:00:00Z")
seconds = calendar.timegm(time.strptime(when, "%Y-%m-%dT%H:%M:%SZ"))
whole = work / f"shearcell-{version}-linux-x86_64"
whole.mkdir()
shutil.copy(work / "shearcell", whole)
libraries = collect_libraries(installed / "bin/shearcell", whole / "lib")
write_licences(bill, libraries, whole / "licences")
inside = {f"shearcell/program/{file.relative_to(whole)}": file
          for file in sorted(whole.rglob("*")) if file.is_file()}
made = [out / backend.write(out, version, seconds, inside)]
for page in (installed / "share/man").rglob("*.1"):
    (whole / "man/man1").mkdir(parents=True, exist_ok=True)
    shutil.copy(page, whole / "man/man1")
documents = [source / name for name in ("README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE")]
for folder in ("core", "protocols", "provenance", "analysis", "experiments"):
    documents += [file for file in (source / folder).rglob("*.md")
                  if not {"node_modules", "install", "results"} & set(file.parts)]
for file in [*documents, *(source / "experiments").glob("*.yaml"), source / "experiments/python/tour.ipynb"]:
    to = whole / file.relative_to(source)
    to.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(file, to)
made.append(out / (whole.name + ".tar.xz"))
write_archive(whole, seconds, made[-1])
for file in made:
    print(f"{file}: {file.stat().st_size / 1e6:.1f} MB")
