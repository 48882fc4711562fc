"""Plots by matplotlib, one call each. matplotlib is imported when the first plot is asked for."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ._drawing import draws
from .hardware import Circuit, Layout, Plan
from .lti import Cascade, Sections
from .responses import Bode, FrequencyResponse, bode, log_grid
from .signals import Diagnosis, Drive, Identification, Simulation, simulate
from .tolerance import Yield

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def _figure(rows: int, columns: int = 1, *, share_x: bool = True, height: float = 2.6) -> tuple[Figure, Any]:
    """A figure of its own, which no window manager keeps; a notebook shows it as the value of its cell."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError("plots need matplotlib (Debian: apt-get install python3-matplotlib)") from error

    class Shown(Figure):
        def _repr_png_(self) -> bytes:
            out = io.BytesIO()
            self.savefig(out, format="png")
            return out.getvalue()

    figure = Shown(figsize=(3.6 + 3.6 * columns, height * rows), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, columns, sharex=share_x, squeeze=False)


def _label(axes: Axes, x: str, y: str) -> None:
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(True, which="both", alpha=0.3)


@draws(Sections, FrequencyResponse, Bode)
def plot_bode(
    *things: Any,
    frequency_hz: ArrayLike | None = None,
    from_hz: float | None = None,
    to_hz: float | None = None,
    count: int = 400,
    names: Sequence[str] | None = None,
    with_delays: bool = True,
) -> Figure:
    """Magnitude in dB and phase in degrees over frequency in Hz, of anything that bode() takes, or of a Bode."""
    if len(things) == 1 and isinstance(things[0], Bode):
        table = things[0]
    elif len(things) == 1 and isinstance(things[0], FrequencyResponse) and frequency_hz is None:
        name = names[0] if names else "response"
        table = Bode(things[0].frequency_hz, {name: things[0]})
    else:
        table = bode(
            *things, frequency_hz=frequency_hz, from_hz=from_hz, to_hz=to_hz, count=count, names=names, with_delays=with_delays
        )
    figure, ((magnitude,), (phase,)) = _figure(2)
    for name, one in table.responses.items():
        magnitude.semilogx(one.frequency_hz, one.magnitude_db, label=name)
        phase.semilogx(one.frequency_hz, one.phase_deg, label=name)
    _label(magnitude, "", "magnitude (dB)")
    _label(phase, "frequency (Hz)", "phase (°)")
    magnitude.legend()
    return figure


@draws(Cascade)
def plot_cascade(cascade: Cascade, **options: Any) -> Figure:
    """The cascade's Bode plot with the points that it was fitted to."""
    figure = plot_bode(cascade, names=["cascade"], **options)
    if cascade.fit:
        points = cascade.fit["points"]
        figure.axes[0].plot([p["frequency_hz"] for p in points], [p["wanted_db"] for p in points], "o", label="wanted")
        figure.axes[0].legend()
    return figure


@draws(Plan)
def plot_plan(plan: Plan, sections: Sections | None = None, *, count: int = 400) -> Figure:
    """The board as it runs and without delays; and the sections it was made from."""
    low, high = plan.band_hz or (1.0, 1e4)
    f = log_grid(low / 3.0, high * 3.0, count)
    responses = {
        "as it runs": FrequencyResponse(f, plan.response(f)),
        "without delays": FrequencyResponse(f, plan.response_without_delays(f)),
    }
    if sections is not None:
        responses["sections"] = FrequencyResponse(f, sections.response(f))
    return plot_bode(Bode(f, responses))


@draws(Circuit)
def plot_circuit(circuit: Circuit, sections: Sections | None = None, *, count: int = 200, **options: Any) -> Figure:
    """The netlist in ngspice, next to the sections."""
    low, high = circuit.error["band_hz"]
    f = log_grid(low, high, count)
    things = [circuit] + ([sections] if sections is not None else [])
    return plot_bode(*things, frequency_hz=f, names=["netlist", "sections"][: len(things)], **options)


@draws(Layout)
def plot_layout(layout: Layout) -> Figure:
    """Each cause's largest share in d(x), percent of the range of x, largest first."""
    lines = layout.budget["causes"]
    return _bars([line["cause"] for line in lines], [max(line["percent"]) for line in lines], "error of d(x) (% of range)")


def _bars(names: Sequence[str], values: Sequence[float], label: str) -> Figure:
    figure, ((axes,),) = _figure(1, height=max(2.0, 0.8 + 0.28 * len(names)))
    axes.barh(np.arange(len(names)), values)
    axes.set_yticks(np.arange(len(names)), names)
    axes.invert_yaxis()
    _label(axes, label, "")
    return figure


@draws(Simulation)
def plot_simulation(simulation: Simulation) -> Figure:
    """Input and output over time in s; output over input."""
    figure, ((over_time, loop),) = _figure(1, 2, share_x=False, height=3.2)
    over_time.plot(simulation.time_s, simulation.u, label="r" if simulation.drive is not None else "u")
    if simulation.drive is not None:
        over_time.plot(simulation.time_s, simulation.drive, label="u")
    over_time.plot(simulation.time_s, simulation.y, label="y")
    over_time.legend()
    loop.plot(simulation.u, simulation.y, linewidth=0.8)
    _label(over_time, "time (s)", "")
    _label(loop, "r" if simulation.drive is not None else "u", "y")
    return figure


@draws(Drive)
def plot_drive(drive: Drive) -> Figure:
    """Reference and drive, and the predicted error, over time in s."""
    figure, ((signals,), (error,)) = _figure(2)
    signals.plot(drive.time_s, drive.reference, label="reference")
    signals.plot(drive.time_s, drive.u, label="drive")
    signals.legend()
    error.plot(drive.time_s, drive.predicted - drive.reference, linewidth=0.8)
    _label(signals, "", "")
    _label(error, "time (s)", "predicted error")
    return figure


@draws(Identification)
def plot_identification(identification: Identification) -> Figure:
    """The first record and the model on it, and their difference, over time in s."""
    record = identification.records[0]
    assert record.y is not None
    run = simulate(identification.model, record, start="equilibrium", engine="record", estimate_error=False)
    figure, ((signals,), (error,)) = _figure(2)
    signals.plot(record.time_s, record.y, label="record")
    signals.plot(record.time_s, run.y, label="model")
    signals.legend()
    error.plot(record.time_s, run.y - record.y, linewidth=0.8)
    _label(signals, "", "y")
    _label(error, "time (s)", "model − record")
    return figure


@draws(Diagnosis)
def plot_diagnosis(diagnosis: Diagnosis) -> Figure:
    """The held-out rms before, after each effect, and at the end."""
    gap = diagnosis.gap
    names = ["the model as given", *(f"+ {step['effect']}" for step in diagnosis.steps), "in the end"]
    values = [gap["initial"]["holdout_rms"], *(step["holdout_rms_after"] for step in diagnosis.steps), gap["final"]["holdout_rms"]]
    return _bars(names, values, "held-out rms")


@draws(Yield)
def plot_yield(statistics: Yield) -> Figure:
    """Deviation in dB over frequency in Hz: the median, 95 % of the circuits, and the extremes, of each design."""
    figure, ((axes,),) = _figure(1, height=3.4)
    for i, design in enumerate(statistics.designs):
        f, table = design["frequency_hz"], design["magnitude_db"]
        colour = f"C{i}"
        axes.fill_between(f, table["min"], table["max"], color=colour, alpha=0.12, linewidth=0)
        axes.fill_between(f, table["p2_5"], table["p97_5"], color=colour, alpha=0.3, linewidth=0)
        axes.semilogx(f, table["p50"], color=colour, label=design["name"])
    axes.legend()
    _label(axes, "frequency (Hz)", "deviation (dB)")
    return figure
