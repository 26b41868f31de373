# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the bill of materials: the fields that CycloneDX 1.5 requires, and that it lists every part of the program.
   python3 bill.py BUILD_FOLDER SOURCE_FOLDER"""
import hashlib
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

build, source = Path(sys.argv[1]), Path(sys.argv[2])
text = (build / "experiments/install/shearcell.cdx.json").read_text()
bill = json.loads(text)
wrong = []


def expect(true, message):
    if not true:
        wrong.append(message)


def members(what, value, required, allowed):
    """The specification's objects have no members but those that it names."""
    expect(required <= value.keys(), f"{what} lacks {required - value.keys()}")
    expect(value.keys() <= required | allowed, f"{what} has {value.keys() - required - allowed}")


# What the specification (https://cyclonedx.org/docs/1.5/json) says of the members that are here.
references = []
hash_digits = {"SHA-256": 64, "SHA-512": 128}


def check_component(part, place):
    name = f"{place}/{part.get('name')}"
    members(name, part, {"type", "name"},
            {"bom-ref", "version", "hashes", "licenses", "purl", "properties", "components"})
    expect(part["type"] in {"application", "library", "file"}, f"{name}: type {part['type']}")
    expect(part["name"], f"{place}: a component without name")
    if "bom-ref" in part:
        expect(part["bom-ref"], f"{name}: an empty bom-ref")
        references.append(part["bom-ref"])
    for entry in part.get("hashes", []):
        members(f"{name} hash", entry, {"alg", "content"}, set())
        expect(re.fullmatch(r"[0-9a-f]+", entry["content"])
               and len(entry["content"]) == hash_digits.get(entry["alg"]), f"{name}: hash {entry}")
    licences = part.get("licenses", [])
    expect(len(licences) == 1 or all("license" in entry for entry in licences),
           f"{name}: an expression stands alone")
    for entry in licences:
        members(f"{name} licence", entry, set(), {"license", "expression"})
        expect(len(entry) == 1, f"{name}: a licence or an expression")
        if "license" in entry:
            members(f"{name} licence", entry["license"], {"name"}, {"url"})
    if "purl" in part:
        expect(re.fullmatch(r"pkg:[a-z]+(/[\w.%-]+)+@[\w.%:~-]+(\?[\w=&.:~-]+)?", part["purl"]),
               f"{name}: purl {part['purl']}")
    for entry in part.get("properties", []):
        members(f"{name} property", entry, {"name"}, {"value"})
        expect(isinstance(entry.get("value"), str), f"{name}: property {entry}")
    for inner in part.get("components", []):
        check_component(inner, name)


members("bill", bill, {"bomFormat", "specVersion"}, {"serialNumber", "version", "metadata", "components"})
expect(bill["bomFormat"] == "CycloneDX" and bill["specVersion"] == "1.5" and bill["version"] == 1, "not CycloneDX 1.5")
expect(re.fullmatch(r"urn:uuid:[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}", bill["serialNumber"]), "serialNumber")
members("metadata", bill["metadata"], {"component"}, {"timestamp"})
expect(re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", bill["metadata"].get("timestamp", "2000-01-01T00:00:00Z")), "timestamp")
check_component(bill["metadata"]["component"], "program")
for part in bill["components"]:
    check_component(part, "library")
expect(len(references) == len(set(references)), "a bom-ref stands twice")

# Every library that the loader takes, with the hash of the file that it takes.
files = {f["name"]: f["hashes"][0]["content"] for c in bill["components"] for f in c.get("components", [])}
loaded = re.findall(r"(/\S+) \(0x", subprocess.run(["ldd", build / "shearcell"], capture_output=True, text=True, check=True).stdout)
expect(len(loaded) > 10, f"ldd lists {loaded}")
for path in map(Path, loaded):
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    expect(files.get(path.name) == digest, f"{path}: {files.get(path.name, 'not in the bill')}, is {digest}")
expect(files.keys() == {Path(path).name for path in loaded}, "the bill has files that the loader does not take")

# Every npm package that is in the front end, as its lock file has it.
bundled = set(re.findall(r"^(\S+) (\S+) \(([^()]+)\)$", (build / "experiments/report/web/bundle/licences.txt").read_text(), re.M))
npm = {(c["name"], c["version"], c["licenses"][0]["expression"]) for c in bill["components"]
       if c.get("purl", "").startswith("pkg:npm/")}
expect(npm == bundled, f"npm packages: {npm ^ bundled}")
locked = json.loads((source / "experiments/report/web/package-lock.json").read_text())["packages"]
for name, version, licence in npm:
    entry = locked[f"node_modules/{name}"]
    expect((entry["version"], entry["license"]) == (version, licence), f"{name}: the lock file has {entry}")

# Every Debian source package whose headers were compiled in, but for the compiler's own and the kernel's.
counted = 0
if shutil.which("ninja") and shutil.which("dpkg-query"):
    own = re.compile(r"^(core|protocols|provenance|analysis|experiments)/")
    headers, wanted = set(), False
    for line in subprocess.run(["ninja", "-t", "deps"], cwd=build, capture_output=True, text=True, check=True).stdout.splitlines():
        if line and not line.startswith(" "):
            wanted = bool(own.match(line))
        elif wanted and line.startswith("    /usr/include/"):
            headers.add(line.strip())
    said = subprocess.run(["dpkg-query", "-S", *sorted(headers)], capture_output=True, text=True).stdout
    packages = {word.split(":")[0] for line in said.splitlines() for word in line.rsplit(": ", 1)[0].split(", ")}
    sources = lambda names: set(subprocess.run(["dpkg-query", "-W", "-f", "${source:Package}\n", "libc6", *sorted(names)],
                                               capture_output=True, text=True, check=True).stdout.split())
    named = {c["name"] for c in bill["components"] if c.get("purl", "").startswith("pkg:deb/")}
    used = sources(packages) - {"linux", "glibc"}
    counted = len(used)
    expect(counted > 8, f"headers of {used} only")
    expect(used <= sources(named), f"headers of these were compiled in: {used - sources(named)}")
    for component in bill["components"]:
        if "purl" in component and component["purl"].startswith("pkg:deb/"):
            expect(component.get("version") and component.get("licenses"), f"{component['name']}: version, licence")

for message in wrong:
    print(message)
print(f"{len(bill['components'])} components: {len(files)} shared libraries, {len(npm)} npm packages, "
      f"headers of {counted} source packages looked up; {len(wrong)} faults")
sys.exit(bool(wrong))
