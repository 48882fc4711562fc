"""controller: the whole analog controller of a disturbance; an FPAA board's streams and trim."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from ._call import FloatArray, Progress, call
from .documents import Document
from .hardware import Plan
from .lti import Sections
from .models import Disturbance
from .responses import FrequencyResponse


class Controller(Document):
    """The analog controller of a disturbance: inverse, rate gains, branch switch (`controller.json`).

    `files`: controller.sub (`.subckt controller r v`: 1 V at r is full stroke wanted, 1 V at v full-stroke drive), parts.csv,
    bom.csv, controller.svg, a KiCad project.
    """

    _name = "analog_controller"
    _file = "controller.json"

    @property
    def tracking(self) -> list[dict[str, Any]]:
        """One entry a tracked frequency: frequency_hz, errors of a stage that reads its drive in percent of range, as they are and
        without the lag; by ngspice with check=True, else by CVODE."""
        return self._data.get("as_built", self._data.get("predicted", []))

    @property
    def netlist(self) -> str:
        """controller.sub."""
        return self.files["controller.sub"]

    def _summary(self) -> str:
        return f"{self._data['form']}, {len(self._data['parts'])} parts"


def controller(
    disturbance: Disturbance,
    *,
    form: Literal["self-fed", "two-pass", "seed"] = "self-fed",
    track_hz: Sequence[float] = (1, 10, 20, 40, 60, 80, 100),
    waveform: Literal["triangle", "sine", "two_tone", "decaying_triangle"] = "triangle",
    amplitude: float = 1.0,
    constant: bool = False,
    full_stroke: bool = False,
    rate_tolerance_percent: float | None = None,
    averaging_s: float | None = None,
    series: str = "E96",
    opamp: str | None = None,
    fast_opamp: str | None = None,
    multiplier_scale_v: float | None = None,
    lowest_hz: float | None = None,
    allow_unstable: bool = False,
    check: bool = False,
    progress: Progress | None = None,
) -> Controller:
    """The whole analog controller as one circuit, and how well a stage that reads its drive, y = v + K(f) d(v), tracks with it.

    Args:
        form: self-fed: v = r − K d(v); two-pass: v = r − K d(r − K d(r)); seed: v = r − K d(r).
        track_hz: frequencies that are tracked; the gain curve's corners are put there where they fit.
        waveform, amplitude: of the reference; amplitude of the full stroke.
        constant: without rate gains. full_stroke: without amplitude gains, which the circuit does not make. rate_tolerance_percent: of the gain curve's straight pieces, percent of range.
        averaging_s: time constant after the slope's rectifier (default: a hundredth of the shortest period).
        series: of the resistors. opamp, fast_opamp: types; the fast one is the slope detector's.
        multiplier_scale_v: U in W = X Y/U + Z. lowest_hz: slowest triangle that the slope detector must follow.
        allow_unstable: go on with a phase margin below 30 degrees, which is a DesignError otherwise.
        check: run ngspice on the netlist at every tracked frequency.
    """
    options = {
        "disturbance": disturbance,
        "form": form,
        "track_hz": list(track_hz),
        "waveform": waveform,
        "amplitude": amplitude,
        "constant": constant,
        "full_stroke": full_stroke,
        "rate_tolerance_percent": rate_tolerance_percent,
        "averaging_s": averaging_s,
        "series": series,
        "opamp": opamp,
        "fast_opamp": fast_opamp,
        "multiplier_scale_v": multiplier_scale_v,
        "lowest_hz": lowest_hz,
        "allow_unstable": allow_unstable,
        "check": check,
    }
    return Controller._from(call("controller", options, None, progress), disturbance)


class Streams:
    """Complete configuration streams of a plan's chips, derived from public material and not tried on silicon.

    Attributes:
        files: chipN.ahf (a two-digit hex byte a line), primary.c, first_power_on.md.
        details: chips (address, bytes, pins), constants, warnings, largest_difference_percent between what the plan does and what
            the bytes, read back, make.
    """

    def __init__(self, files: dict[str, str], details: dict[str, Any]) -> None:
        self.files = files
        self.details = details

    def bytes_of(self, chip: int) -> bytes:
        """The stream of one chip."""
        return bytes(int(line, 16) for line in self.files[f"chip{chip}.ahf"].split())

    def __repr__(self) -> str:
        return f"<bodesmith.Streams {len(self.details['chips'])} chips>"


def streams(plan: Plan, *, pins: Mapping[str, int] | None = None) -> Streams:
    """Configuration streams of a plan. DesignError where a CAM's bytes are not publicly known, or its clocks need two system
    divisors: `fpaa(…, min_clock_hz=31373)` makes plans that need none.

    Args:
        pins: I/O cells of pins, {"chip1.out1": 3} for IO3 (1 to 7).
    """
    answer = call("fpaa_streams", {"plan": plan, "pins": dict(pins) if pins else None})
    return Streams(answer.files, answer.result)


def trim(
    plan: Plan,
    measured: FrequencyResponse,
    *,
    phase: bool = True,
    sections: Sections | None = None,
    target: Plan | None = None,
    measurement_percent: float | None = None,
    unit_array: Literal["binary", "nested"] = "binary",
    unit_capacitor_percent: float | None = None,
    systematic_units: float | None = None,
    samples: int = 400,
    band_hz: tuple[float, float] | None = None,
    seed: int = 1,
    progress: Progress | None = None,
) -> Plan:
    """New capacitors for a built board, from the response measured on it. `to_dict()["trim"]` says the error before and after and
    which capacitors changed; the old ones stay where better is not certain.

    Args:
        measured: the built board's response as it runs. phase: use its phase too.
        sections, target: what the board shall do (one of them): sections, or the plan as it was designed when the board was
            trimmed before; default: what `plan` does with exact capacitors.
        measurement_percent: standard deviation of a measured value (default: found from the measurement).
        unit_array: how a capacitor's number chooses its units (not publicly known).
        samples: boards that agree with the measurement, on all of which the new capacitors are better.
    """
    options = {
        "plan": plan,
        "sections": sections,
        "target": target,
        "measurement_percent": measurement_percent,
        "unit_array": unit_array,
        "unit_capacitor_percent": unit_capacitor_percent,
        "systematic_units": systematic_units,
        "samples": samples,
        "band_hz": band_hz,
        "seed": seed,
    }
    arrays: dict[str, FloatArray] = {
        "frequency_hz": measured.frequency_hz,
        "gain": np.ascontiguousarray(measured.gain),
    }
    if phase:
        arrays["phase_deg"] = np.ascontiguousarray(np.degrees(np.angle(measured.response)))
    return Plan._from(call("fpaa_trim", options, arrays, progress), plan)
