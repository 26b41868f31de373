#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads an exported RO-Crate with other code than wrote it: python3 check_crate.py FOLDER

Finds the root as the specification of RO-Crate 1.1 says, checks every file's size and SHA-256 and,
where the module prov (Debian: python3-prov) is installed, reads prov.json with it.
"""
import hashlib
import json
import pathlib
import sys

folder = pathlib.Path(sys.argv[1])
graph = json.loads((folder / "ro-crate-metadata.json").read_text())["@graph"]
entities = {entity["@id"]: entity for entity in graph}
assert len(entities) == len(graph), "an id occurs twice"

roots = [
    entities[entity["about"]["@id"]]
    for entity in graph
    if isinstance(entity.get("conformsTo"), dict)
    and entity["conformsTo"]["@id"].startswith("https://w3id.org/ro/crate/")
]
assert len(roots) == 1 and roots[0]["@type"] == "Dataset", roots

files = [entity for entity in graph if entity["@type"] == "File"]
assert {file["@id"] for file in files} == {part["@id"] for part in roots[0]["hasPart"]}
for file in files:
    data = (folder / file["@id"]).read_bytes()
    assert len(data) == int(file["contentSize"]), file["@id"]
    assert hashlib.sha256(data).hexdigest() == file["sha256"], file["@id"]
actions = [entity for entity in graph if entity["@type"] == "CreateAction"]
assert actions and {a["@id"] for a in actions} == {m["@id"] for m in roots[0]["mentions"]}
print(f"{len(graph)} entities, {len(files)} files, {len(actions)} actions")

try:
    from prov.model import ProvActivity, ProvDocument
except ImportError:
    print("prov.json not read: the module prov is not installed")
    sys.exit(0)
document = ProvDocument.deserialize(str(folder / "prov.json"))
activities = list(document.get_records(ProvActivity))
assert len(activities) == len(actions), "attempts in prov.json and in the crate differ"
print(f"prov.json: {len(document.get_records())} records")
