# SPDX-License-Identifier: GPL-3.0-or-later
"""Replaces what a document has between the lines <!-- NAME --> and <!-- end --> by what standard input has between them:
    MEASURE | python3 insert_tables.py DOCUMENT [check]
With `check` nothing is written, and other text is an error."""

import pathlib
import re
import sys

document = pathlib.Path(sys.argv[1])
text = old = document.read_text()
blocks = re.findall(r"<!-- (?!end )[\w-]+ -->\n.*?<!-- end -->\n", sys.stdin.read(), re.S)
if not blocks:
    sys.exit("nothing to insert")
for block in blocks:
    heading = block.splitlines()[0]
    text, found = re.subn(re.escape(heading) + r"\n.*?<!-- end -->\n", lambda _: block, text, flags=re.S)
    if found != 1:
        sys.exit(f"{document}: has {found} blocks that begin with {heading}")
if sys.argv[2:] == ["check"]:
    if text != old:
        new = [line for line in text.splitlines() if line not in old.splitlines()]
        sys.exit(f"{document} has other text than was measured. Its blocks would have these lines:\n" + "\n".join(new))
else:
    document.write_text(text)
