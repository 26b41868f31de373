# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs experiments with the program shearcell, and reads its stores.

>>> import shearcell
>>> store = shearcell.run("experiments/drag.yaml", scale="smoke")   # or a dict, or a text
>>> store.figure("S2")                        # shows itself in a notebook
>>> store.verdicts()                          # pandas.DataFrame
>>> store.table(per="run")                    # pandas.DataFrame, by the program's `table`
>>> store.run("3f9a").checkpoint(5).position  # (N, 3) [d]
"""
from typing import Any

from .figures import Figure
from .program import ShearcellError, plan, run
from .store import Run, Store

__all__ = ["Checkpoint", "Figure", "Run", "ShearcellError", "Store", "plan", "run"]


def __getattr__(name: str) -> Any:
    if name == "Checkpoint":  # it alone needs numpy and h5py
        from .store import checkpoint_class

        return checkpoint_class()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
