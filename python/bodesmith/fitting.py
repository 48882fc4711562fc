"""fit, approximate, design: from what is wanted to a cascade or sections."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from ._call import FloatArray, Progress, call, parts, signal
from .documents import PathLike
from .errors import InputError
from .lti import Cascade, Sections
from .models import Disturbance
from .responses import FrequencyResponse

Points = tuple[ArrayLike, ArrayLike]
"""(frequency_hz, gain)"""


class BodePoints:
    """Wanted (or measured) points of a Bode plot.

    Attributes:
        frequency_hz: shape (N,), rising.
        gain: linear, shape (N,).
        phase_deg: shape (N,) or None.
        weight: shape (N,).
    """

    def __init__(self, frequency_hz: FloatArray, gain: FloatArray, phase_deg: FloatArray | None, weight: FloatArray) -> None:
        self.frequency_hz = frequency_hz
        self.gain = gain
        self.phase_deg = phase_deg
        self.weight = weight
        self.origins: list[dict[str, str]] = []

    @property
    def magnitude_db(self) -> FloatArray:
        """20 log10 gain, shape (N,)."""
        return 20.0 * np.log10(self.gain)

    def __len__(self) -> int:
        return self.frequency_hz.size


def read_points(path: PathLike) -> BodePoints:
    """Bode points: CSV `frequency_hz` and `gain` or `magnitude_db`, optional `phase_deg`, `weight`, or any foreign format
    that the program reads. Raises InputError with `.file` and `.line`."""
    answer = call("read_points", {"path": os.fspath(path)})
    arrays = answer.arrays
    out = BodePoints(arrays["frequency_hz"], arrays["gain"], arrays.get("phase_deg"), arrays["weight"])
    out.origins = answer.result["inputs"]
    return out


def _point_arrays(
    frequency_hz: ArrayLike | BodePoints,
    gain: ArrayLike | None,
    magnitude_db: ArrayLike | None,
    phase_deg: ArrayLike | None = None,
    weight: ArrayLike | None = None,
) -> dict[str, FloatArray]:
    if isinstance(frequency_hz, BodePoints):
        if gain is not None or magnitude_db is not None:
            raise InputError("points have their own gains, expected neither gain nor magnitude_db")
        points = frequency_hz
        frequency_hz, gain = points.frequency_hz, points.gain
        phase_deg = points.phase_deg if phase_deg is None else phase_deg
        weight = points.weight if weight is None else weight
    if (gain is None) == (magnitude_db is None):
        raise InputError("expected either gain or magnitude_db")
    linear = signal(gain, "gain") if gain is not None else 10.0 ** (signal(magnitude_db, "magnitude_db") / 20.0)  # type: ignore[arg-type]
    out = {"frequency_hz": signal(frequency_hz, "frequency_hz"), "gain": linear}
    if phase_deg is not None:
        out["phase_deg"] = signal(phase_deg, "phase_deg")
    if weight is not None:
        out["weight"] = signal(weight, "weight")
    return out


def fit_cascade(
    frequency_hz: ArrayLike | BodePoints,
    gain: ArrayLike | None = None,
    *,
    magnitude_db: ArrayLike | None = None,
    weight: ArrayLike | None = None,
    base_hz: float | None = None,
    beta_max: float | None = None,
    beta_positive: bool = False,
    fewest_bands_db: float | None = None,
    surprise_db: float = 0.5,
    progress: Progress | None = None,
) -> Cascade:
    """A cascade of fractional compensators through target gains,

        G(s) = gain Π ((λ_i s + 1)/(x_i λ_i s + 1))^β_i,   λ_i = 1/(2π f_i), x_i = f_i/f_(i+1).

    Args:
        frequency_hz: shape (N,), in any order; or BodePoints.
        gain: linear, shape (N,); or `magnitude_db`.
        weight: of the squared errors, shape (N,).
        base_hz: frequency of gain 1 at which the first band starts; default: the lowest point.
        beta_max: bounded least squares, |β| at most this; without it every point above the base is met.
        beta_positive: with beta_max: 0 ≤ β.
        fewest_bands_db: the fewest bands that keep every point within this.
        surprise_db: warn where the curve leaves the range of neighbouring points by more.
    """
    options = {
        "base_hz": base_hz,
        "beta_max": beta_max,
        "beta_positive": beta_positive,
        "fewest_bands_db": fewest_bands_db,
        "surprise_db": surprise_db,
    }
    arrays = _point_arrays(frequency_hz, gain, magnitude_db, None, weight)
    return Cascade._from(call("fit_cascade", options, arrays, progress), frequency_hz)


def fit_direct(
    frequency_hz: ArrayLike | BodePoints,
    gain: ArrayLike | None = None,
    *,
    magnitude_db: ArrayLike | None = None,
    phase_deg: ArrayLike | None = None,
    weight: ArrayLike | None = None,
    order: int | None = None,
    max_error_db: float | None = None,
    real: bool = False,
    least_squares: bool = False,
    relative_degree: int = 0,
    use_phase: bool = False,
    max_corner_hz: float | None = None,
    min_damping: float = 0.05,
    upper: Points | None = None,
    lower: Points | None = None,
    seed: int = 1,
    progress: Progress | None = None,
) -> Sections:
    """Stable, minimum-phase integer sections straight to target gains: the smallest largest error in dB.

    Args:
        frequency_hz, gain, magnitude_db, weight: as fit_cascade().
        phase_deg: shape (N,), used with `use_phase`.
        order: poles, 1 to 12; without it the smallest order that meets `max_error_db`.
        real: real poles and zeros only.
        least_squares: the smallest rms error in dB instead.
        relative_degree: poles minus zeros.
        max_corner_hz: no pole or zero above it.
        min_damping: of complex pairs.
        upper, lower: masks (frequency_hz, gain) that the gain must stay below and above.
        seed: of the random starts.
    """
    arrays = _point_arrays(frequency_hz, gain, magnitude_db, phase_deg, weight)
    for name, mask in (("_upper", upper), ("_lower", lower)):
        if mask is not None:
            arrays["frequency_hz" + name] = signal(mask[0], "frequency_hz" + name)
            arrays["gain" + name] = signal(mask[1], "gain" + name)
    options = {
        "order": order,
        "max_error_db": max_error_db,
        "real": real,
        "least_squares": least_squares,
        "relative_degree": relative_degree,
        "use_phase": use_phase,
        "max_corner_hz": max_corner_hz,
        "min_damping": min_damping,
        "seed": seed,
    }
    return Sections._from(call("fit_direct", options, arrays, progress), frequency_hz)


def fit_measured(
    frequency_hz: ArrayLike | FrequencyResponse,
    response: ArrayLike | None = None,
    *,
    order: int | None = None,
    max_order: int = 16,
    delay: bool = True,
    progress: Progress | None = None,
) -> Sections:
    """A model of a measured complex response,

        H(s) = e^(−s delay) gain Π(s − z)/Π(s − p),

    poles stable, zeros in either half plane; the order chosen by held-out points. `.report` has the standard deviations of
    poles, zeros, gain and delay, and the orders that were tried.

    Args:
        frequency_hz: shape (N,), at least 8; or a FrequencyResponse.
        response: complex, shape (N,).
        order: poles; default: chosen, up to `max_order`.
        delay: look for a pure delay.
    """
    measured = frequency_hz
    if isinstance(frequency_hz, FrequencyResponse):
        response = frequency_hz.response
        frequency_hz = frequency_hz.frequency_hz
    if response is None:
        raise InputError("response is missing")
    arrays = {"frequency_hz": signal(frequency_hz, "frequency_hz"), "response": parts(response, "response")}
    options = {"order": order, "max_order": max_order, "delay": delay}
    return Sections._from(call("fit_measured", options, arrays, progress), measured)


def fit_waveform(
    disturbance: Disturbance,
    *,
    order: int = 2,
    norm: Literal["rms", "worst"] = "rms",
    branch: Literal["whole", "ascending", "descending"] | None = None,
    operating_hz: ArrayLike | None = None,
    seed: int = 1,
    progress: Progress | None = None,
) -> Sections:
    """Sections that minimise the time-domain error of the compensating waveform over all operating frequencies.

    Args:
        order: poles, 1 to 6.
        norm: rms over the operating frequencies, or the worst of them.
        branch: whole (after the branch switch), or that polynomial's own path; default: the one that needs a compensator.
        operating_hz: shape (N,), instead of the rate table's frequencies.
    """
    options = {
        "disturbance": disturbance,
        "order": order,
        "norm": norm,
        "branch": branch,
        "operating_hz": None if operating_hz is None else signal(operating_hz, "operating_hz"),
        "seed": seed,
    }
    return Sections._from(call("fit_waveform", options, None, progress), disturbance)


@overload
def fit(*arguments: Any, kind: Literal["cascade"] = "cascade", **options: Any) -> Cascade: ...
@overload
def fit(*arguments: Any, kind: Literal["direct", "measured", "waveform"], **options: Any) -> Sections: ...
def fit(*arguments: Any, kind: Literal["cascade", "direct", "measured", "waveform"] = "cascade", **options: Any) -> Cascade | Sections:
    """fit_cascade(), fit_direct(), fit_measured() or fit_waveform(), by `kind`."""
    kinds: dict[str, Callable[..., Cascade | Sections]]
    kinds = {"cascade": fit_cascade, "direct": fit_direct, "measured": fit_measured, "waveform": fit_waveform}
    if kind not in kinds:
        raise InputError(f"kind is '{kind}', expected one of {', '.join(kinds)}")
    return kinds[kind](*arguments, **options)


def approximate(
    cascade: Cascade,
    *,
    method: str = "minimax",
    order: int | None = None,
    max_error_db: float | None = None,
    max_order: int = 12,
    over_band: bool = False,
    complex_roots: bool = False,
    merge_db: float | None = None,
    biquads: bool = False,
    arrange: bool = False,
    progress: Progress | None = None,
) -> Sections:
    """Integer sections for the fractional terms of a cascade. `.error` is against the cascade.

    Args:
        method: minimax, oustaloup, refined-oustaloup, matsuda, carlson, pade … (`bodesmith.methods()`).
        order: poles of each term's approximation, whole powers counted inside it (default 4).
        max_error_db: instead: the fewest poles with which the whole cascade stays within this at every frequency.
        over_band: minimax: equal ripple between the corners instead of over all frequencies.
        complex_roots: minimax with |β| > 2: allow complex pairs.
        merge_db: leave out pole-zero pairs that nearly cancel while the error stays within this.
        biquads: pairs of real poles as one second-order section.
        arrange: pair and order the sections for the smallest internal span.
    """
    options = {
        "cascade": cascade,
        "method": method,
        "order": order,
        "max_error_db": max_error_db,
        "max_order": max_order,
        "over_band": over_band,
        "complex": complex_roots,
        "merge_db": merge_db,
        "biquads": biquads,
        "arrange": arrange,
    }
    return Sections._from(call("approximate", options, None, progress), cascade)


Terms = Sequence[tuple[float, float]]


def approximate_fractional(
    numerator: Terms | None = None,
    denominator: Terms | None = None,
    *,
    band_hz: tuple[float, float],
    pid: Mapping[str, float] | None = None,
    order: int | None = None,
    max_error_db: float | None = None,
    max_order: int = 12,
    real: bool = False,
    keep_integrator: bool = False,
    seed: int = 1,
    progress: Progress | None = None,
) -> Sections:
    """Integer sections for a transfer function of fractional powers,

        G(s) = (Σ b_i s^β_i)/(Σ a_k s^α_k),   or C(s) = kp + ki s^−λ + kd s^μ,

    fitted as a whole: minimax in dB and degrees over the band. DesignError when it is unstable or not minimum-phase.

    Args:
        numerator, denominator: (coefficient, power) each.
        pid: instead: {"kp": …, "ki": …, "lambda": …, "kd": …, "mu": …}; what is missing is 0.
        band_hz: where it is approximated.
        order: poles (default 4). max_error_db: instead: the fewest, up to max_order, that stay within this.
        real: real poles and zeros only.
        keep_integrator: an integrator stays one, as poles at 0; otherwise the gain at rest is finite.

    `to_dict()["approximation"]` has errors, stability and poles_at_0.
    """
    transfer: dict[str, Any] = {"schema": "bodesmith.fractional/1"}
    if pid is not None:
        transfer["pid"] = dict(pid)
    for name, terms in (("numerator", numerator), ("denominator", denominator)):
        if terms is not None:
            transfer[name] = [{"coefficient": float(c), "power": float(p)} for c, p in terms]
    options = {
        "transfer": transfer,
        "band_hz": list(band_hz),
        "order": order,
        "max_error_db": max_error_db,
        "max_order": max_order,
        "real": real,
        "keep_integrator": keep_integrator,
        "seed": seed,
    }
    return Sections._from(call("approximate_fractional", options, None, progress))


def design(
    kind: str,
    *,
    family: str | None = None,
    order: int | None = None,
    corner_hz: float | Sequence[float] | None = None,
    ripple_db: float | None = None,
    stop_db: float | None = None,
    pass_hz: float | Sequence[float] | None = None,
    stop_hz: float | Sequence[float] | None = None,
    gain_db: float | None = None,
    q: float | None = None,
    delay_s: float | None = None,
) -> Sections:
    """Standard filters and equalisers.

    Args:
        kind: lowpass, highpass, bandpass, bandstop; peaking, low-shelf, high-shelf, delay (an all-pass).
        family: butterworth (default), chebyshev1, chebyshev2, elliptic, bessel, gaussian, linkwitz-riley … (`bodesmith.families()`).
        order: of the low-pass prototype: a band filter has twice as many poles.
        corner_hz: −3 dB (butterworth, bessel, gaussian), −6 dB (linkwitz-riley), edge of the ripple (chebyshev1, elliptic) or
            of the stop band (chebyshev2); for band filters both corners.
        ripple_db: largest attenuation in the pass band (0.5).
        stop_db: least attenuation in the stop band (60).
        pass_hz, stop_hz: instead of order and corner: a mask (edges; for band filters both), kept by the least order.
        gain_db, q: equalisers.
        delay_s: of the all-pass, H(s) = θ(−s T/2)/θ(s T/2).
    """
    options = {
        "kind": kind,
        "family": family,
        "order": order,
        "corner_hz": corner_hz,
        "ripple_db": ripple_db,
        "stop_db": stop_db,
        "pass_hz": pass_hz,
        "stop_hz": stop_hz,
        "gain_db": gain_db,
        "q": q,
        "delay_s": delay_s,
    }
    return Sections._from(call("design", options))


def methods() -> list[str]:
    """Names of the approximation methods."""
    return call("names").result["methods"]


def families() -> list[str]:
    """Names of the filter families."""
    return call("names").result["families"]
