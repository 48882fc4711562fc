"""Frequency responses: of a cascade, sections, a plan, a linear model, a netlist."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ._call import ComplexArray, FloatArray, call, parts, signal
from ._drawing import draw
from .documents import PathLike
from .errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class FrequencyResponse:
    """H(j 2π f) at given frequencies.

    Attributes:
        frequency_hz: shape (N,), rising.
        response: complex, shape (N,); no unit.
        coherence: shape (N,) where a measurement has it, else None.
    """

    def __init__(self, frequency_hz: ArrayLike, response: ArrayLike, coherence: ArrayLike | None = None) -> None:
        self.frequency_hz: FloatArray = signal(frequency_hz, "frequency_hz")
        self.response: ComplexArray = parts(response, "response").view(np.complex128)
        self.coherence = None if coherence is None else signal(coherence, "coherence")
        self.origins: list[dict[str, str]] = []
        if self.response.size != self.frequency_hz.size:
            raise InputError(f"response has {self.response.size} values, expected {self.frequency_hz.size}")

    @property
    def gain(self) -> FloatArray:
        """|H|, shape (N,)."""
        return np.abs(self.response)

    @property
    def magnitude_db(self) -> FloatArray:
        """20 log10 |H| in dB, shape (N,)."""
        with np.errstate(divide="ignore"):
            return 20.0 * np.log10(np.abs(self.response))

    @property
    def phase_deg(self) -> FloatArray:
        """Phase in degrees without jumps of more than half a turn, shape (N,)."""
        return np.degrees(np.unwrap(np.angle(self.response)))

    @property
    def group_delay_s(self) -> FloatArray:
        """−dφ/dω in seconds, shape (N,), by differences between neighbouring frequencies: as good as the grid is dense."""
        return -np.gradient(np.unwrap(np.angle(self.response)), 2.0 * np.pi * self.frequency_hz)

    def to_frd(self) -> Any:
        """A python-control FrequencyResponseData; ImportError when `control` is not installed."""
        from .control_bridge import frd

        return frd(self.frequency_hz, self.response)

    def plot(self, **options: Any) -> Figure:
        """Bode plot; see plot_bode."""
        return draw(self, **options)

    def __repr__(self) -> str:
        f = self.frequency_hz
        band = f", {f[0]:g} to {f[-1]:g} Hz" if f.size else ""
        return f"<bodesmith.FrequencyResponse {f.size} frequencies{band}>"


def log_grid(from_hz: float, to_hz: float, count: int = 200) -> FloatArray:
    """`count` frequencies in Hz, evenly spaced in log frequency, both ends included."""
    if not 0.0 < from_hz <= to_hz:
        raise InputError(f"the band {from_hz} to {to_hz} Hz is empty, expected 0 < from_hz <= to_hz")
    return np.geomspace(from_hz, to_hz, count)


def response_of(thing: Any, frequency_hz: ArrayLike, *, with_delays: bool = True, subcircuit: str = "") -> FrequencyResponse:
    """The response of anything that has one, at the given frequencies.

    Args:
        thing: a Cascade, Sections, Plan, Model (linear blocks), Circuit (its netlist through ngspice), a
            FrequencyResponse (interpolated in log frequency), a path of a netlist (.sub, .lib, .cir, through ngspice), or
            any callable of s = j 2π f.
        frequency_hz: shape (N,), above 0.
        with_delays: plans: as the board runs, every clock, hold and delay; otherwise the capacitors' transfer alone.
        subcircuit: of a library with several: its name.
    """
    f = signal(frequency_hz, "frequency_hz")
    if isinstance(thing, FrequencyResponse):
        return _interpolated(thing, f)
    if isinstance(thing, (str, os.PathLike)):
        options = {"path": os.fspath(thing), "subcircuit": subcircuit}
        return _unpack(f, call("netlist_response", options, {"frequency_hz": f}).arrays)
    files = getattr(thing, "files", {})
    if "compensator.sub" in files:
        options = {"text": files["compensator.sub"], "name": "compensator.sub", "subcircuit": subcircuit}
        return _unpack(f, call("netlist_response", options, {"frequency_hz": f}).arrays)
    if hasattr(thing, "to_dict"):
        options = {"of": thing.to_dict(), "with_delays": with_delays}
        return _unpack(f, call("response", options, {"frequency_hz": f}).arrays)
    if callable(thing):
        return FrequencyResponse(f, np.asarray(thing(2j * np.pi * f)))
    raise InputError(f"a {type(thing).__name__} has no frequency response")


def _unpack(f: FloatArray, arrays: Mapping[str, FloatArray]) -> FrequencyResponse:
    return FrequencyResponse(f, arrays["response"].view(np.complex128))


def _interpolated(known: FrequencyResponse, f: FloatArray) -> FrequencyResponse:
    slack = 1.0 + 1e-9
    if f.size and (f.min() * slack < known.frequency_hz[0] or f.max() > known.frequency_hz[-1] * slack):
        raise InputError("frequency_hz goes beyond the response that is known")
    at, grid = np.log(f), np.log(known.frequency_hz)
    magnitude = np.interp(at, grid, np.log(known.gain))
    phase = np.interp(at, grid, np.unwrap(np.angle(known.response)))
    return FrequencyResponse(f, np.exp(magnitude + 1j * phase))


class Bode:
    """Responses of several things at the same frequencies.

    Attributes:
        frequency_hz: shape (N,).
        responses: FrequencyResponse by name, in the order given.
    """

    def __init__(self, frequency_hz: FloatArray, responses: dict[str, FrequencyResponse]) -> None:
        self.frequency_hz = frequency_hz
        self.responses = responses

    def __getitem__(self, name: str) -> FrequencyResponse:
        return self.responses[name]

    @property
    def response(self) -> ComplexArray:
        """Of the first thing: complex, shape (N,)."""
        return next(iter(self.responses.values())).response

    @property
    def magnitude_db(self) -> FloatArray:
        """Of the first thing, in dB, shape (N,)."""
        return next(iter(self.responses.values())).magnitude_db

    @property
    def phase_deg(self) -> FloatArray:
        """Of the first thing, unwrapped, shape (N,)."""
        return next(iter(self.responses.values())).phase_deg

    def plot(self, **options: Any) -> Figure:
        """Bode plot of all; see plot_bode."""
        return draw(self, **options)

    def __repr__(self) -> str:
        return f"<bodesmith.Bode {', '.join(self.responses)}; {self.frequency_hz.size} frequencies>"


def band_of(things: Sequence[Any]) -> tuple[float, float]:
    """The corners of all things and a decade to both sides (measured responses: their own range), in Hz."""
    low, high = np.inf, 0.0
    for thing in things:
        if isinstance(thing, FrequencyResponse):
            low, high = min(low, thing.frequency_hz[0]), max(high, thing.frequency_hz[-1])
            continue
        band = getattr(thing, "band_hz", None)
        if band is not None:
            low, high = min(low, band[0] / 10.0), max(high, band[1] * 10.0)
    return (low, high) if low <= high else (1.0, 1e5)


def bode(
    *things: Any,
    frequency_hz: ArrayLike | None = None,
    from_hz: float | None = None,
    to_hz: float | None = None,
    count: int = 200,
    names: Sequence[str] | None = None,
    with_delays: bool = True,
    subcircuit: str = "",
) -> Bode:
    """Frequency responses in one table.

    Args:
        things: whatever response_of() takes.
        frequency_hz: the frequencies, shape (N,); without them `count` of them from `from_hz` to `to_hz`, and without these
            the frequencies of the first measured response, or a decade beyond all corners.
        names: of the things; default: file names, or kinds.
    """
    if not things:
        raise InputError("there is nothing to take a response of")
    if frequency_hz is not None:
        f = signal(frequency_hz, "frequency_hz")
    else:
        measured = [one for one in things if isinstance(one, FrequencyResponse)]
        if measured and from_hz is None and to_hz is None:
            f = measured[0].frequency_hz
        else:
            band = band_of(things)
            f = log_grid(band[0] if from_hz is None else from_hz, band[1] if to_hz is None else to_hz, count)
    named = list(names) if names is not None else [_name_of(one) for one in things]
    if len(named) != len(things):
        raise InputError(f"names has {len(named)} words, expected {len(things)}")
    out: dict[str, FrequencyResponse] = {}
    for name, thing in zip(_unique(named), things):
        out[name] = response_of(thing, f, with_delays=with_delays, subcircuit=subcircuit)
    return Bode(f, out)


def _name_of(thing: Any) -> str:
    if isinstance(thing, (str, os.PathLike)):
        return os.path.splitext(os.path.basename(os.fspath(thing)))[0]
    return type(thing).__name__.lower()


def _unique(names: Sequence[str]) -> list[str]:
    out: list[str] = []
    for name in names:
        number, one = 1, name
        while one in out:
            number += 1
            one = f"{name}_{number}"
        out.append(one)
    return out


def read_response(path: PathLike) -> FrequencyResponse:
    """A measured response: CSV `frequency_hz,magnitude_db,phase_deg` (optional `coherence`), or any foreign format that the
    program reads. Raises InputError with `.file` and `.line`."""
    answer = call("read_response", {"path": os.fspath(path)})
    arrays = answer.arrays
    out = FrequencyResponse(arrays["frequency_hz"], arrays["response"].view(np.complex128), arrays.get("coherence"))
    out.origins = answer.result["inputs"]
    return out
