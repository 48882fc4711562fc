"""Margins of open loops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ._call import call
from .errors import InputError
from .responses import band_of


@dataclass(frozen=True)
class Margins:
    """How far an open loop L(jω) is from making 1/(1 + L) unstable.

    Attributes:
        phase_margin_deg, phase_margin_hz, delay_margin_s: of the crossing |L| = 1 nearest to instability: 180° + arg L, where,
            and the delay that uses it up; None where |L| does not cross 1 in the band.
        gain_margin_db, gain_margin_hz: −20 log10 |L| where L is real and below 0 (below 0 dB: beyond −1); None without.
        max_sensitivity, max_sensitivity_hz: largest |1/(1 + L)| in the band.
        closed_loop_stable: by the turns round −1, for loops of sections alone without poles in the right half plane; else None.
        details: all crossings.
    """

    phase_margin_deg: float | None
    phase_margin_hz: float | None
    delay_margin_s: float | None
    gain_margin_db: float | None
    gain_margin_hz: float | None
    max_sensitivity: float
    max_sensitivity_hz: float
    closed_loop_stable: bool | None
    details: dict[str, Any]


def margins(
    *loop: Any,
    band_hz: Sequence[float] | None = None,
    count: int = 4000,
    with_delays: bool = True,
) -> Margins:
    """Gain, phase and delay margin of the product of Cascades, Sections, Plans and linear Models as an open loop.

    Args:
        loop: the factors, one after the other without loading each other.
        band_hz: where crossings are looked for (default: a decade beyond all corners), at `count` frequencies, refined.
        with_delays: plans as the board runs.
    """
    if not loop:
        raise InputError("there is no loop, expected at least one response")
    options = {
        "loop": [factor.to_dict() if hasattr(factor, "to_dict") else _refuse(factor) for factor in loop],
        "band_hz": list(band_hz) if band_hz is not None else list(band_of(loop)),
        "count": count,
        "with_delays": with_delays,
    }
    found = call("margins", options).result
    phase: dict[str, float] = min(found["gain_crossings"], key=lambda one: abs(one["phase_margin_deg"]), default={})
    gain: dict[str, float] = min(found["phase_crossings"], key=lambda one: abs(one["gain_margin_db"]), default={})
    return Margins(
        phase.get("phase_margin_deg"),
        phase.get("frequency_hz"),
        phase.get("delay_margin_s"),
        gain.get("gain_margin_db"),
        gain.get("frequency_hz"),
        found["max_sensitivity"],
        found["max_sensitivity_hz"],
        found["closed_loop_stable"],
        found,
    )


def _refuse(factor: Any) -> Any:
    raise InputError(f"a {type(factor).__name__} is no factor of a loop, expected Cascades, Sections, Plans or linear Models")
