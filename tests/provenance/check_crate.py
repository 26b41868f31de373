#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks an exported RO-Crate with other code than wrote it: python3 check_crate.py FOLDER

The root is where the specification of RO-Crate 1.1 says; every entity has a type and terms of the
crate's contexts; every reference leads somewhere; every file is there as described, and no other.
"""
import hashlib
import json
import pathlib
import re
import sys

# Of schema.org 10.0, the context of RO-Crate 1.1; sha256 is from the workflow-run context.
TERMS = set(
    "@id @type about actionStatus conformsTo contentSize dateCreated datePublished description "
    "encodingFormat endTime error hasPart identifier instrument license location mentions name "
    "object result sha256 softwareRequirements softwareVersion startTime value version".split())
TYPES = set("CreateAction CreativeWork Dataset File PropertyValue SoftwareApplication Place".split())
MOMENT = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z")

folder = pathlib.Path(sys.argv[1])
metadata = json.loads((folder / "ro-crate-metadata.json").read_text())
assert metadata["@context"] == ["https://w3id.org/ro/crate/1.1/context",
                                "https://w3id.org/ro/terms/workflow-run/context"]
graph = metadata["@graph"]
entities = {entity["@id"]: entity for entity in graph}
assert len(entities) == len(graph), "an id occurs twice"


def of_type(kind):
    return [entity for entity in graph if entity["@type"] == kind]


for entity in graph:
    assert entity["@type"] in TYPES, entity
    for key, value in entity.items():
        assert key in TERMS, key
        for inner in value if isinstance(value, list) else [value]:
            if isinstance(inner, dict):
                assert list(inner) == ["@id"], f"{entity['@id']}.{key} is nested"
                to = inner["@id"]
                assert to in entities or to.startswith("http"), f"{entity['@id']} -> {to}"

descriptor = entities["ro-crate-metadata.json"]
assert descriptor["@type"] == "CreativeWork"
assert descriptor["conformsTo"]["@id"] == "https://w3id.org/ro/crate/1.1"
root = entities[descriptor["about"]["@id"]]
assert root["@id"] == "./" and root["@type"] == "Dataset" and root["name"] and root["description"]
assert MOMENT.fullmatch(root["datePublished"])
licence = entities[root["license"]["@id"]]
assert licence["name"] and licence["description"]
profile = entities[root["conformsTo"][0]["@id"]]
assert (profile["@id"], profile["version"]) == ("https://w3id.org/ro/wfrun/process/0.5", "0.5")

files = of_type("File")
assert {file["@id"] for file in files} == {part["@id"] for part in root["hasPart"]}
for file in files:
    assert not file["@id"].startswith("/") and ".." not in file["@id"]
    data = (folder / file["@id"]).read_bytes()
    assert file["contentSize"] == str(len(data)), file["@id"]
    assert file["sha256"] == hashlib.sha256(data).hexdigest(), file["@id"]
    assert isinstance(file["encodingFormat"], str)
present = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
assert present == {file["@id"] for file in files} | {"ro-crate-metadata.json"}

actions = of_type("CreateAction")
assert actions and {a["@id"] for a in actions} == {m["@id"] for m in root["mentions"]}
for action in actions:
    assert MOMENT.fullmatch(action["startTime"])
    failed = action["actionStatus"]["@id"] == "http://schema.org/FailedActionStatus"
    assert failed == ("error" in action)
    assert all("sha256" in entities[result["@id"]] for result in action["result"])

print(f"{len(graph)} entities, {len(files)} files, {len(actions)} actions")
