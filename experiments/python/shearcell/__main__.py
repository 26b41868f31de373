# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `shearcell` of a wheel: becomes the program, with its arguments."""
import os
import sys

from .program import ShearcellError, find_program


def main() -> None:
    try:
        program = find_program()
    except ShearcellError as missing:
        sys.exit(f"shearcell: {missing}")
    os.execv(program, ["shearcell", *sys.argv[1:]])


if __name__ == "__main__":
    main()
