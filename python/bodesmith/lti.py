"""Cascades of fractional compensators, and integer sections."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ._call import ComplexArray, FloatArray
from ._drawing import draw
from .documents import Document
from .errors import InputError
from .responses import FrequencyResponse, response_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class _Linear(Document):
    """Something with a frequency response and corners."""

    @property
    def band_hz(self) -> tuple[float, float] | None:
        """Lowest and highest corner in Hz; None when there is none."""
        raise NotImplementedError

    def response(self, frequency_hz: ArrayLike) -> ComplexArray:
        """H(j 2π f), complex, shape (N,)."""
        return response_of(self, frequency_hz).response

    def at(self, frequency_hz: ArrayLike) -> FrequencyResponse:
        """The same with magnitude in dB and phase in degrees."""
        return response_of(self, frequency_hz)

    def to_frd(self, frequency_hz: ArrayLike) -> Any:
        """A python-control FrequencyResponseData at these frequencies."""
        return response_of(self, frequency_hz).to_frd()


class Cascade(_Linear):
    """Fractional compensators in series,

        G(s) = gain Π ((λ_i s + 1)/(x_i λ_i s + 1))^β_i,

    λ in seconds, x and β without unit; corners at 1/(2π λ) and 1/(2π x λ) Hz.

    Args:
        terms: (lambda_s, x, beta) each.
    """

    _name = "cascade"

    def __init__(self, terms: Iterable[Sequence[float]] = (), gain: float = 1.0) -> None:
        rows = [dict(zip(("lambda_s", "x", "beta"), map(float, term), strict=True)) for term in terms]
        made = Cascade.from_dict({"gain": float(gain), "terms": rows})
        super().__init__(made._data)

    @property
    def gain(self) -> float:
        return float(self._data["gain"])

    @property
    def lambda_s(self) -> FloatArray:
        """Shape (terms,), seconds."""
        return np.array([term["lambda_s"] for term in self._data["terms"]], dtype=float)

    @property
    def x(self) -> FloatArray:
        """Shape (terms,)."""
        return np.array([term["x"] for term in self._data["terms"]], dtype=float)

    @property
    def beta(self) -> FloatArray:
        """Shape (terms,)."""
        return np.array([term["beta"] for term in self._data["terms"]], dtype=float)

    @property
    def fit(self) -> dict[str, Any] | None:
        """What the fit says of itself: points, rms_db, max_db, condition_number, sensitivities …; None without one."""
        return self._data.get("fit")

    @property
    def band_hz(self) -> tuple[float, float] | None:
        corners = np.concatenate([1.0 / self.lambda_s, 1.0 / (self.x * self.lambda_s)]) / (2.0 * np.pi)
        return (float(corners.min()), float(corners.max())) if corners.size else None

    def plot(self, **options: Any) -> Figure:
        """Its Bode plot, with the points that it was fitted to."""
        return draw(self, **options)

    def _summary(self) -> str:
        return f"gain {self.gain:g}, {len(self.beta)} terms, beta {np.array2string(self.beta, precision=4)}"


class Sections(_Linear):
    """Integer sections in series,

        H(s) = gain e^(−s delay) Π_i k_i Π(s − z)/Π(s − p),   s, z, p in rad/s,

    each with one or two poles.

    Args:
        sections: (k, zeros_rad_s, poles_rad_s) each; complex roots with their conjugates.
        delay_s: a pure delay, as measured responses have.
    """

    _name = "sections"

    def __init__(self, sections: Iterable[tuple[float, ArrayLike, ArrayLike]] = (), gain: float = 1.0, delay_s: float = 0.0) -> None:
        rows = [{"gain": float(k), "zeros_rad_s": _pairs(zeros), "poles_rad_s": _pairs(poles)} for k, zeros, poles in sections]
        data: dict[str, Any] = {"gain": float(gain), "sections": rows}
        if delay_s != 0.0:
            data["delay_s"] = float(delay_s)
        super().__init__(Sections.from_dict(data)._data)

    @property
    def gain(self) -> float:
        return float(self._data["gain"])

    @property
    def delay_s(self) -> float:
        return float(self._data.get("delay_s", 0.0))

    @property
    def sections(self) -> list[tuple[float, ComplexArray, ComplexArray]]:
        """(k, zeros, poles) of each, rad/s."""
        return [(float(s["gain"]), _roots(s["zeros_rad_s"]), _roots(s["poles_rad_s"])) for s in self._data["sections"]]

    @property
    def zeros_rad_s(self) -> ComplexArray:
        """All zeros, rad/s."""
        return np.concatenate([zeros for _, zeros, _ in self.sections] or [np.zeros(0, complex)])

    @property
    def poles_rad_s(self) -> ComplexArray:
        """All poles, rad/s."""
        return np.concatenate([poles for _, _, poles in self.sections] or [np.zeros(0, complex)])

    @property
    def error(self) -> dict[str, Any] | None:
        """Against what they approximate: band_hz, max_magnitude_db, max_phase_deg, everywhere_max_magnitude_db."""
        return self._data.get("error")

    @property
    def report(self) -> dict[str, Any]:
        """What the command that made them says: of `fit`, `waveform_fit`, `approximation` or `design`; else empty."""
        for key in ("fit", "waveform_fit", "approximation", "design"):
            if key in self._data:
                return self._data[key]
        return {}

    @property
    def band_hz(self) -> tuple[float, float] | None:
        corners = np.abs(np.concatenate([self.zeros_rad_s, self.poles_rad_s])) / (2.0 * np.pi)
        corners = corners[corners > 0.0]
        return (float(corners.min()), float(corners.max())) if corners.size else None

    def to_control(self, pade_order: int | None = None) -> Any:
        """A python-control StateSpace, one section behind the other (polynomials of many poles would lose digits).

        Args:
            pade_order: for sections with a delay, which a state space does not hold: order of its Padé approximation.
        """
        from .control_bridge import control_module, section_state_space, series

        control = control_module()
        whole: Any = None
        for k, zeros, poles in self.sections:
            one = section_state_space(k, zeros, poles)
            whole = one if whole is None else series(whole, one)
        if whole is None:
            empty = np.zeros((0, 0))
            whole = (empty, np.zeros((0, 1)), np.zeros((1, 0)), np.ones((1, 1)))
        a, b, c, d = whole
        system = control.StateSpace(a, b, self.gain * c, self.gain * d)
        if self.delay_s == 0.0:
            return system
        if pade_order is None:
            raise InputError(f"the sections have a delay of {self.delay_s:g} s, which a state space does not hold: give pade_order")
        return control.series(system, control.TransferFunction(*control.pade(self.delay_s, pade_order)))

    def plot(self, **options: Any) -> Figure:
        """Bode plot; see plot_bode."""
        return draw(self, **options)

    def _summary(self) -> str:
        delay = f", delay {self.delay_s:g} s" if self.delay_s else ""
        return f"gain {self.gain:g}, {len(self._data['sections'])} sections, {self.poles_rad_s.size} poles{delay}"


def _pairs(roots: ArrayLike) -> list[list[float]]:
    return [[float(root.real), float(root.imag)] for root in np.atleast_1d(np.asarray(roots, dtype=complex))]


def _roots(pairs: list[list[float]]) -> ComplexArray:
    return np.array([complex(re, im) for re, im in pairs], dtype=complex)
