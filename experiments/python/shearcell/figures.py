# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures that the program has drawn, and how notebooks show them."""
from __future__ import annotations

import base64
import html
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterable

from .program import need

if TYPE_CHECKING:
    import pandas


class Figure:
    """One figure of an experiment. A notebook shows its drawings, its caption and its verdicts.

    Attributes:
        name, experiment, scale: as in the program. `experiment` is "" for a figure of all experiments.
        files: the files that were written: CSV, SVG, PDF, caption, verdicts and lineage.
        undrawn: why drawings are missing, for example because gnuplot is not installed. The CSV files exist.
        facts: the figure's part of `shearcell figures --json`.
    """

    def __init__(self, facts: dict[str, Any]) -> None:
        self.facts = facts
        self.name: str = facts["figure"]
        self.experiment: str = facts["experiment"]
        self.scale: str = facts["scale"]
        self.files = [Path(file).absolute() for file in facts["files"]]
        self.undrawn: list[str] = facts["undrawn"]

    @property
    def drawings(self) -> list[str]:
        """The panels as texts in SVG."""
        return [file.read_text(encoding="utf-8") for file in self.files if file.suffix == ".svg"]

    @property
    def caption(self) -> str:
        return "".join(file.read_text(encoding="utf-8") for file in self.files
                       if file.name.endswith(".caption.txt")).strip()

    @property
    def verdicts(self) -> "pandas.DataFrame":
        """A row for each claim; needs pandas."""
        return verdicts_of([self])

    def _repr_svg_(self) -> str | None:
        drawings = self.drawings
        return drawings[0] if len(drawings) == 1 else None

    def _repr_html_(self) -> str:
        parts = ['<img src="data:image/svg+xml;base64,'
                 f'{base64.b64encode(drawing.encode()).decode()}" style="max-width: 100%">'
                 for drawing in self.drawings]
        parts += [f"<p>{html.escape(text)}</p>" for text in (self.caption, *self.undrawn) if text]
        parts += [f"<p><b>{html.escape(claim['verdict'])}</b>: {html.escape(claim['claim'])} "
                  f"({html.escape(result)})</p>"
                  for claim, result in zip(self.facts["verdict"]["claims"], self.facts["results"])]
        return f"<div>{''.join(parts)}</div>"

    def __repr__(self) -> str:
        return f"<Figure {self.name} of {self.experiment or 'all experiments'}, {len(self.files)} files>"


class Figures(list):
    """A list of figures; a notebook shows all of them."""

    def _repr_html_(self) -> str:
        return "".join(f"<h4>{html.escape(f'{figure.name}, {figure.experiment}')}</h4>{figure._repr_html_()}"
                       for figure in self)


def verdicts_of(figures: Iterable[Figure]) -> "pandas.DataFrame":
    pandas = need("pandas")
    rows = []
    for figure in figures:
        for claim in figure.facts["verdict"]["claims"]:
            low, high = claim["interval"] or (None, None)
            rows.append({"figure": figure.name, "experiment": figure.experiment, "scale": figure.scale,
                         **{key: value for key, value in claim.items() if key != "interval"},
                         "low": low, "high": high})
    first = ["figure", "experiment", "scale", "claim", "verdict", "estimate", "low", "high", "margin"]
    frame = pandas.DataFrame(rows, columns=None if rows else first)
    numbers = {"estimate", "low", "high", "margin", "runs_needed"}.intersection(frame)
    frame = frame.astype(dict.fromkeys(numbers, float))  # a number that is unknown is NaN
    return frame[first + [name for name in frame if name not in first]]
