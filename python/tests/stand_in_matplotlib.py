"""What `bodesmith.plots` uses of matplotlib, for machines without it (whose Debian package brings scipy, sympy and Tk along).

It keeps what is drawn, knows no argument but those in use (named as matplotlib 3.6 names them) and refuses lines of unequal lengths.
Where matplotlib is installed the tests draw with it.
"""

from __future__ import annotations

import pathlib
import sys
import types
from typing import Any

import numpy as np


class Line:
    def __init__(self, x: Any, y: Any, label: str | None) -> None:
        self.points = np.column_stack([np.asarray(x, float), np.asarray(y, float)])  # which wants equal lengths
        self.label = label

    def get_xydata(self) -> np.ndarray:
        return self.points

    def get_ydata(self) -> np.ndarray:
        return self.points[:, 1]


class Text:
    def __init__(self, text: str) -> None:
        self.text = text

    def get_text(self) -> str:
        return self.text


class Legend:
    def __init__(self, labels: list[str]) -> None:
        self.labels = labels

    def get_texts(self) -> list[Text]:
        return [Text(label) for label in self.labels]


class Axes:
    def __init__(self) -> None:
        self.lines: list[Line] = []
        self.patches: list[tuple[float, float]] = []
        self.shown: Legend | None = None

    def plot(self, x: Any, y: Any, fmt: str = "", *, label: str | None = None, linewidth: float | None = None) -> None:
        self.lines.append(Line(x, y, label))

    def semilogx(self, x: Any, y: Any, *, label: str | None = None, color: str | None = None) -> None:
        self.lines.append(Line(x, y, label))

    def fill_between(self, x: Any, y1: Any, y2: Any, *, color: str, alpha: float, linewidth: float) -> None:
        Line(x, y1, None), Line(x, y2, None)

    def barh(self, y: Any, width: Any) -> None:
        self.patches += [(float(a), float(b)) for a, b in zip(y, width, strict=True)]

    def set_yticks(self, ticks: Any, labels: Any) -> None:
        assert len(ticks) == len(labels)

    def invert_yaxis(self) -> None:
        pass

    def set_xlabel(self, xlabel: str) -> None:
        assert isinstance(xlabel, str)

    def set_ylabel(self, ylabel: str) -> None:
        assert isinstance(ylabel, str)

    def grid(self, visible: bool, which: str = "major", *, alpha: float) -> None:
        assert which in ("major", "minor", "both")

    def legend(self) -> None:
        self.shown = Legend([line.label for line in self.lines if line.label])

    def get_lines(self) -> list[Line]:
        return self.lines

    def get_legend(self) -> Legend | None:
        return self.shown


class Figure:
    def __init__(self, figsize: tuple[float, float], *, layout: str) -> None:
        assert layout == "constrained" and min(figsize) > 0
        self.axes: list[Axes] = []

    def subplots(self, nrows: int, ncols: int, *, sharex: bool, squeeze: bool) -> np.ndarray:
        assert not squeeze
        out = np.empty((nrows, ncols), object)
        for place in np.ndindex(nrows, ncols):
            out[place] = Axes()
            self.axes.append(out[place])
        return out

    def savefig(self, fname: Any, *, format: str | None = None) -> None:
        if format is None:
            pathlib.Path(fname).write_bytes({".svg": b"<svg></svg>"}[pathlib.Path(fname).suffix])
        else:
            fname.write({"png": b"\x89PNG"}[format])


def install() -> None:
    """`import matplotlib` finds it from now on."""
    for name, contents in {
        "matplotlib": {},
        "matplotlib.backends": {},
        "matplotlib.backends.backend_agg": {"FigureCanvasAgg": lambda figure: None},
        "matplotlib.figure": {"Figure": Figure},
    }.items():
        module = types.ModuleType(name)
        vars(module).update(contents, __path__=[])
        sys.modules[name] = module
