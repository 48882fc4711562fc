"""How results are drawn. `plots` enters its functions here and results ask for theirs by type, so that they know no plots."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Plot = TypeVar("Plot", bound=Callable[..., Any])
_drawings: dict[type, Callable[..., Any]] = {}


def draws(*kinds: type) -> Callable[[Plot], Plot]:
    """The decorated function draws these and what is derived from them."""

    def enter(plot: Plot) -> Plot:
        _drawings.update(dict.fromkeys(kinds, plot))
        return plot

    return enter


def draw(result: Any, *arguments: Any, **options: Any) -> Figure:
    """The figure of a result."""
    kind = next(kind for kind in type(result).__mro__ if kind in _drawings)
    return _drawings[kind](result, *arguments, **options)
