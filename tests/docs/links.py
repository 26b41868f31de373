#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Link checker: python3 links.py FOLDER [NAME...]

Every relative link and image of the Markdown files in FOLDER (or only of FOLDER/NAME...) must lead to a file or folder, and
every anchor to a heading. Prints file, line and target of those that do not, and ends with code 1. Addresses in the web are
not fetched.
"""
import os
import pathlib
import re
import sys

SKIPPED = {"build", "node_modules", ".git", "broken"}  # "broken" holds the page that must fail


def prose(text):
    """The text without code, with its lines kept."""
    text = re.sub(r"^```.*?^```$", lambda code: "\n" * code[0].count("\n"), text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"^    .*$", "", text, flags=re.MULTILINE)
    return re.sub(r"`[^`\n]*`", "", text)


def anchors(text):
    """The names that GitHub gives to headings."""
    names = set()
    for heading in re.findall(r"^#{1,6} +(.*?) *$", re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL), re.MULTILINE):
        words = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").lower()
        name = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
        count = 0
        while f"{name}-{count}" in names if count else name in names:
            count += 1
        names.add(f"{name}-{count}" if count else name)
    return names


def fault(page, target):
    """What is wrong with a link of a page, or nothing."""
    if re.match(r"[a-z][a-z+.-]*:", target):
        return ""
    path, _, anchor = target.partition("#")
    other = (page.parent / path) if path else page
    if not other.exists():
        return "leads nowhere"
    if anchor and (other.suffix != ".md" or anchor not in anchors(other.read_text())):
        return f"{other.name} has no heading #{anchor}"
    return ""


def pages(folder):
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(set(folders) - SKIPPED)
        yield from (pathlib.Path(place) / name for name in sorted(files) if name.endswith(".md"))


def main():
    folder = pathlib.Path(sys.argv[1])
    faults, links = [], 0
    for page in [folder / name for name in sys.argv[2:]] or pages(folder):
        text = prose(page.read_text())
        for found in re.finditer(r"\[[^]]*\]\(([^)\s]+)\)", text):
            links += 1
            if why := fault(page, found[1]):
                line = text.count("\n", 0, found.start()) + 1
                faults.append(f"{page}:{line}: ({found[1]}) {why}")
    print("\n".join(faults) or f"{links} links lead somewhere")
    return 1 if faults or not links else 0


sys.exit(main())
