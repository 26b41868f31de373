# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads stores of the program shearcell: runs, tables of measures, checkpoints as arrays.

>>> from shearcell import Store
>>> store = Store("shearcell-store")
>>> store.table(per="run")                    # pandas.DataFrame, by the program's `table`
>>> store.run("3f9a").checkpoint(5).position  # (N, 3) [d]

Only the cache `derived.sqlite` is written into a store.
"""
from .checkpoint import Checkpoint
from .store import Run, ShearcellError, Store

__all__ = ["Checkpoint", "Run", "ShearcellError", "Store"]
