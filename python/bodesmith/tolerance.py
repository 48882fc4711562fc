"""yield_: what tolerances do to designs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from ._call import Progress, call
from ._drawing import draw
from .documents import Document
from .errors import InputError
from .hardware import Circuit, Plan
from .lti import Sections

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Yield(Document):
    """Statistics of realised designs (`yield.json`)."""

    _name = "yield"

    @property
    def designs(self) -> list[dict[str, Any]]:
        """One each: percentiles a frequency, worst errors, ranking of the parts, what to buy."""
        return self._data["designs"]

    def plot(self, **options: Any) -> Figure:
        """Median and 90 % band of the deviation over frequency."""
        return draw(self, **options)

    def _summary(self) -> str:
        return ", ".join(f"{one['name']}: {one['worst_db']['p95']:.3g} dB in 95 of 100" for one in self.designs)


def yield_(
    designs: Sections | Circuit | Plan | Sequence[Sections | Circuit | Plan],
    *,
    names: Sequence[str] | None = None,
    sections: Sections | None = None,
    samples: int = 100_000,
    distribution: Literal["uniform", "gaussian", "corners"] = "uniform",
    sigmas: float | None = None,
    resistor_percent: float | None = None,
    capacitor_percent: float | None = None,
    unit_capacitor_percent: float | None = None,
    systematic_units: float | None = None,
    temperature_c: tuple[float, float] | None = None,
    resistor_ppm: float | None = None,
    capacitor_ppm: float | None = None,
    limit_db: float | None = None,
    limit_deg: float | None = None,
    realization: str | None = None,
    series: str | None = None,
    capacitor_series: str | None = None,
    count: int | None = None,
    band_hz: tuple[float, float] | None = None,
    threads: int = 0,
    seed: int = 1,
    progress: Progress | None = None,
) -> Yield:
    """Monte Carlo over the tolerances of op-amp RC parts (Sections, or a Circuit as it was built) or FPAA capacitors (Plans).

    Args:
        designs: one or several. sections: plans: deviations are counted from these sections instead of the plan's own response.
        samples: circuits drawn; sample n depends on (seed, n) alone, whatever the number of threads.
        distribution: uniform within the tolerance, gaussian (`sigmas` standard deviations to a tolerance), or corners.
        resistor_percent, capacitor_percent: tolerances. unit_capacitor_percent, systematic_units: FPAA, assumptions.
        temperature_c: every circuit is at a temperature in this range; resistor_ppm, capacitor_ppm in 1/K.
        limit_db, limit_deg: count the circuits that stay within, and say which tolerances to buy for it.
        realization, series, capacitor_series: the circuit of Sections, as spice().
        count, band_hz: of the frequencies (default: 60, and more where the response turns); default band: the corners of the first design.
    """
    group = [designs] if isinstance(designs, (Sections, Circuit, Plan)) else list(designs)
    called = list(names) if names is not None else [f"{type(one).__name__.lower()}{i + 1}" for i, one in enumerate(group)]
    if len(called) != len(group):
        raise InputError(f"names has {len(called)} words, expected {len(group)}")
    options = {
        "designs": group,
        "names": called,
        "sections": sections,
        "samples": samples,
        "distribution": distribution,
        "sigmas": sigmas,
        "resistor_percent": resistor_percent,
        "capacitor_percent": capacitor_percent,
        "unit_capacitor_percent": unit_capacitor_percent,
        "systematic_units": systematic_units,
        "temperature_c": temperature_c,
        "resistor_ppm": resistor_ppm,
        "capacitor_ppm": capacitor_ppm,
        "limit_db": limit_db,
        "limit_deg": limit_deg,
        "realization": realization,
        "series": series,
        "capacitor_series": capacitor_series,
        "count": count,
        "band_hz": band_hz,
        "threads": threads,
        "seed": seed,
    }
    return Yield._from(call("yield", options, None, progress), *group, sections)
