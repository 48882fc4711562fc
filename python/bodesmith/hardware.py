"""fpaa, spice, layout: hardware for sections and disturbances."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from numpy.typing import ArrayLike

from ._call import ComplexArray, Progress, call
from ._drawing import draw
from .documents import Document
from .lti import Sections, _Linear
from .models import Disturbance
from .responses import response_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Plan(_Linear):
    """Sections as switched-capacitor CAMs on an FPAA board (`plan.json`): chips, CAMs, capacitors, clocks, wires.

    response() is the board as it runs, at the input's own frequency: every clock, hold and half-cycle delay in it.
    `files`: build_sheet.md, build_sheet.html, board.svg (and board.sub, board.cir with netlist=True).
    """

    _name = "fpaa_plan"
    _file = "plan.json"

    @property
    def chips(self) -> list[dict[str, Any]]:
        return self.to_dict()["chips"]

    @property
    def cams(self) -> list[dict[str, Any]]:
        """All CAMs with requested and realised values, capacitors, clock, z-domain coefficients."""
        return [cam for chip in self.chips for cam in chip["cams"]]

    @property
    def error(self) -> dict[str, Any]:
        """Capacitors against the sections, without holds and delays: band_hz, max_magnitude_db, max_phase_deg, max_complex_percent."""
        return self._data["error"]

    @property
    def error_with_delays(self) -> dict[str, Any]:
        """The board as it runs against the sections."""
        return self._data["error_with_delays"]

    @property
    def budget(self) -> dict[str, Any] | None:
        """Each cause of error by itself: holds, mismatch, settling, noise; None where it was read from a file without."""
        return self._data.get("budget")

    @property
    def band_hz(self) -> tuple[float, float] | None:
        low, high = self._data["error"]["band_hz"]
        return (float(low), float(high))

    def response_without_delays(self, frequency_hz: ArrayLike) -> ComplexArray:
        """The capacitors' own transfer, without holds and delays; complex, shape (N,)."""
        return response_of(self, frequency_hz, with_delays=False).response

    def plot(self, sections: Sections | None = None, **options: Any) -> Figure:
        """Bode plot of the board as it runs and without delays, and of the sections it was made from."""
        return draw(self, sections, **options)

    def _summary(self) -> str:
        worst = self.error_with_delays["max_complex_percent"]
        return f"{self._data['board']}: {len(self.cams)} CAMs, {worst:.3g} % as it runs"


class Circuit(Document):
    """Sections as op-amp RC stages with parts that can be bought.

    `files`: compensator.sub, decks for ngspice, LTspice and Xyce, a KiCad project, parts.csv.
    """

    _name = "circuit"

    @property
    def error(self) -> dict[str, Any]:
        """Of each step against the sections (parts, op-amps, together): magnitude in dB, phase in degrees, complex in percent."""
        return self._data["error"]

    @property
    def netlist(self) -> str:
        """compensator.sub: `.subckt compensator in out`."""
        return self.files["compensator.sub"]

    def response(self, frequency_hz: ArrayLike) -> ComplexArray:
        """V(out)/V(in) of the netlist in ngspice (which must be installed); complex, shape (N,)."""
        return response_of(self, frequency_hz).response

    def plot(self, sections: Sections | None = None, **options: Any) -> Figure:
        """Bode plot of the netlist in ngspice, next to the sections."""
        return draw(self, sections, **options)

    def _summary(self) -> str:
        stages = self._data["stages"]
        judged = self._data.get("judged", {}).get("max_magnitude_db")
        error = "" if judged is None else f", {judged:.3g} dB with parts and op-amps"
        return f"{len(stages)} stages, {sum(len(stage['parts']) for stage in stages)} parts{error}"


class Layout(Document):
    """The disturbance generator as multipliers, weighted sums and a branch switch.

    `files`: disturbance.sub (`.subckt disturbance x branch out`), parts.csv, layout.svg.
    """

    _name = "layout"

    @property
    def budget(self) -> dict[str, Any]:
        """Offsets, scales and tolerances: what each cause adds to d(x), percent of the range of x."""
        return self._data["budget"]

    @property
    def netlist(self) -> str:
        """disturbance.sub."""
        return self.files["disturbance.sub"]

    def plot(self, **options: Any) -> Figure:
        """The error budget as bars."""
        return draw(self, **options)

    def _summary(self) -> str:
        return f"{len(self._data.get('multipliers', []))} multipliers"


def fpaa(
    sections: Sections,
    *,
    board: str = "an231k04-quad4",
    topology: Literal["auto", "chain", "bilinear"] = "auto",
    clock_hz: float | None = None,
    min_clock_hz: float | None = None,
    band_hz: tuple[float, float] | None = None,
    unit_capacitor_percent: float | None = None,
    systematic_units: float | None = None,
    unit_capacitance_f: float | None = None,
    opamp_bandwidth_hz: float | None = None,
    opamp_gain: float | None = None,
    switch_ohm: float | None = None,
    netlist: bool = False,
    seed: int = 1,
    progress: Progress | None = None,
) -> Plan:
    """CAMs of an FPAA board for sections: clocks, capacitors, places, wires. DesignError when they do not fit.

    Args:
        topology: auto, chain (CAMs that AnadigmDesigner2 has, alone), bilinear (FilterBilinear, one chip, one clock).
        clock_hz: one clock for all, as a chain. min_clock_hz: no clock below it.
        band_hz: where errors are minimised and stated; default: over the corners.
        unit_capacitor_percent, systematic_units, unit_capacitance_f: assumptions on the chip (the vendor does not publish them).
        opamp_bandwidth_hz, opamp_gain, switch_ohm: how late stages follow, in every figure then; default: at once.
        netlist: also the plan as switched capacitors, `files["board.sub"]`.
        seed: of the mismatch draws.
    """
    options = {
        "sections": sections,
        "board": board,
        "topology": topology,
        "clock_hz": clock_hz,
        "min_clock_hz": min_clock_hz,
        "band_hz": band_hz,
        "unit_capacitor_percent": unit_capacitor_percent,
        "systematic_units": systematic_units,
        "unit_capacitance_f": unit_capacitance_f,
        "opamp_bandwidth_hz": opamp_bandwidth_hz,
        "opamp_gain": opamp_gain,
        "switch_ohm": switch_ohm,
        "netlist": netlist,
        "seed": seed,
    }
    return Plan._from(call("fpaa", options, None, progress), sections)


def spice(
    sections: Sections,
    *,
    realization: str = "opamp-rc",
    series: str = "E96",
    capacitor_series: str | None = None,
    opamp: str = "generic-10M",
    min_ohm: float | None = None,
    max_ohm: float | None = None,
    min_f: float | None = None,
    max_f: float | None = None,
    isolation_ohm: float | None = None,
    amplitude_v: float = 1.0,
    band_hz: tuple[float, float] | None = None,
    check: bool = False,
    progress: Progress | None = None,
) -> Circuit:
    """An op-amp RC circuit for sections. DesignError when a corner cannot be reached with the parts.

    Args:
        realization: opamp-rc (chooses for each stage), first-order, tow-thomas, khn, sallen-key, multiple-feedback; ladders
            foster1, foster2, cauer1, cauer2.
        series: of the resistors, E3 to E192, or exact. capacitor_series: default E12, or exact with exact.
        opamp: a type of the list, auto, or ideal.
        min_ohm, max_ohm, min_f, max_f: parts that may be used.
        amplitude_v: largest input, for the checks of slew rate and swing.
        band_hz: where errors are stated; default: a decade beyond the corners.
        check: run ngspice and compare; the outcome is in to_dict()["ngspice"].
    """
    options = {
        "sections": sections,
        "realization": realization,
        "series": series,
        "capacitor_series": capacitor_series,
        "opamp": opamp,
        "min_ohm": min_ohm,
        "max_ohm": max_ohm,
        "min_f": min_f,
        "max_f": max_f,
        "isolation_ohm": isolation_ohm,
        "amplitude_v": amplitude_v,
        "band_hz": band_hz,
        "check": check,
    }
    return Circuit._from(call("spice", options, None, progress), sections)


def layout(
    disturbance: Disturbance,
    *,
    series: str = "E96",
    scheme: str = "auto",
    multiplier_scale_v: float | None = None,
    full_scale_v: float | None = None,
    lowest_hz: float | None = None,
    highest_hz: float | None = None,
    check: bool = False,
    progress: Progress | None = None,
) -> Layout:
    """The disturbance generator d(x) in multipliers, sums and a switch.

    Args:
        series: of the resistors.
        scheme: shared (powers), horner, "2" to "6" (powers to a group), or auto.
        multiplier_scale_v: U in W = X Y/U + Z.
        full_scale_v: largest voltage at any node but the output.
        lowest_hz, highest_hz: reference frequencies (triangle) that the slope detector must follow.
        check: run ngspice; the outcome is in to_dict()["ngspice"].
    """
    options = {
        "disturbance": disturbance,
        "series": series,
        "scheme": scheme,
        "multiplier_scale_v": multiplier_scale_v,
        "full_scale_v": full_scale_v,
        "lowest_hz": lowest_hz,
        "highest_hz": highest_hz,
        "check": check,
    }
    return Layout._from(call("layout", options, None, progress), disturbance)
