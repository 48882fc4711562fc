"""simulate, compensate, identify, diagnose: models and records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from ._call import FloatArray, Progress, call, parts, signal
from ._drawing import draw
from .documents import Document
from .errors import InputError
from .models import Model, Record, as_record
from .responses import FrequencyResponse

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Simulation:
    """A model's output.

    Attributes:
        u: input (in a loop: the reference), shape (N,). y: output, shape (N,).
        drive: in a loop: what the model was driven with, shape (N,); else None.
        start_s, step_s: times of the samples.
        error_estimate: of the numerical method, in units of y; None when it was not asked for.
        engine: exact, record or cvode.
        details: steps, model_error_relative, timing_s …
        warnings: what the engine could do approximately only.
    """

    def __init__(self, record: Record, y: FloatArray, drive: FloatArray | None, details: dict[str, Any], warnings: list[str]) -> None:
        self.u = record.u
        self.y = y
        self.drive = drive
        self.start_s = record.start_s
        self.step_s = record.step_s
        self.error_estimate: float | None = details.get("error_estimate")
        self.engine: str = details["engine"]
        self.details = details
        self.warnings = warnings

    @property
    def time_s(self) -> FloatArray:
        """Shape (N,), seconds."""
        return self.start_s + self.step_s * np.arange(self.y.size)

    @property
    def record(self) -> Record:
        """Input and output as a Record."""
        return Record(self.u, self.y, step_s=self.step_s, start_s=self.start_s, name="the simulation")

    def plot(self, **options: Any) -> Figure:
        """Input and output over time, and output over input."""
        return draw(self, **options)

    def __repr__(self) -> str:
        return f"<bodesmith.Simulation {self.y.size} samples by engine {self.engine}>"


def simulate(
    model: Model,
    u: Record | ArrayLike,
    *,
    step_s: float | None = None,
    time_s: ArrayLike | None = None,
    start_s: float = 0.0,
    engine: Literal["automatic", "exact", "record", "cvode"] = "automatic",
    start: Literal["zero", "equilibrium"] | None = None,
    tolerance: float = 1e-8,
    oversample: int = 1,
    estimate_error: bool = True,
    controller: Mapping[str, Any] | None = None,
    feedforward: Model | ArrayLike | None = None,
    progress: Progress | None = None,
) -> Simulation:
    """The model's output for an input that is a straight line between samples.

    Args:
        u: a Record, or input samples, shape (N,), with `step_s` (and `start_s`) or `time_s`. A contiguous float64 array is
            read where it lies; the output is handed over without copying.
        engine: automatic: in closed form where there is one, else from sample to sample, refined until `tolerance` is met;
            exact: closed form or InputError; record: from sample to sample with one step; cvode: as an ODE with events.
        start: states zero, or at rest under the first input; None: what the model's own `start` says, zero where it has none.
        oversample: record: steps a sample interval.
        estimate_error: a second, finer run (record, cvode).
        controller: closes a loop round the model, which then follows u as its reference: {"type": "pid", "kp": …,
            "ki_per_s": …, "kd_s": …, "derivative_corner_hz": …, "sample_s": …, "lower": …, "upper": …}.
        feedforward: of the loop: a Model of the reference, or a drive worked out before, shape (N,).
    """
    record = as_record(u, step_s, time_s, start_s)
    options: dict[str, Any] = {
        "model": model,
        "step_s": record.step_s,
        "start_s": record.start_s,
        "engine": engine,
        "start": start,
        "tolerance": tolerance,
        "oversample": oversample,
        "estimate_error": estimate_error,
    }
    arrays = {"u": record.u}
    if controller is not None:
        options["controller"] = {"schema": "bodesmith.controller/1", **controller}
    if feedforward is not None:
        if controller is None:
            raise InputError("feedforward belongs to a loop, expected a controller with it")
        if isinstance(feedforward, Model):
            options["feedforward"] = feedforward
        else:
            arrays["drive"] = signal(feedforward, "feedforward")
    answer = call("simulate", options, arrays, progress)
    return Simulation(record, answer.arrays["y"], answer.arrays.get("drive"), answer.result, answer.warnings)


class Sweep:
    """Figures of the last period of every run; arrays of shape (N,), frequencies outermost.

    Attributes:
        frequency_hz, amplitude: of the reference.
        rms_percent, max_percent: output against input, percent of the output's range.
        loop_height_percent: of the hysteresis loop, percent of the output's range.
        gain_db, phase_deg: of the fundamental. distortion_percent: harmonics 2 to 20 over it.
        error_estimate: of the simulation, in units of the output.
    """

    def __init__(self, arrays: Mapping[str, FloatArray]) -> None:
        self.frequency_hz = arrays["frequency_hz"]
        self.amplitude = arrays["amplitude"]
        self.rms_percent = arrays["rms_percent"]
        self.max_percent = arrays["max_percent"]
        self.loop_height_percent = arrays["loop_height_percent"]
        self.gain_db = arrays["gain_db"]
        self.phase_deg = arrays["phase_deg"]
        self.distortion_percent = arrays["distortion_percent"]
        self.error_estimate = arrays["error_estimate"]

    def __repr__(self) -> str:
        return f"<bodesmith.Sweep {self.frequency_hz.size} runs>"


def sweep(
    model: Model,
    frequency_hz: ArrayLike,
    amplitude: ArrayLike = 0.5,
    *,
    kind: Literal["triangle", "sine", "stair"] = "triangle",
    offset: float | None = None,
    periods: int = 3,
    samples_per_period: int = 1000,
    controller: Mapping[str, Any] | None = None,
    feedforward: Model | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """A model, or a loop round it, under a periodic reference of every frequency and amplitude; on all cores.

    Args:
        frequency_hz, amplitude: shape (N,) and (M,) or a number: N·M runs.
        offset: of the reference; default: its amplitude, so that it starts at 0.
        periods: of each run; the last one counts.
        controller, feedforward: as in simulate().
    """
    options: dict[str, Any] = {
        "model": model,
        "kind": kind,
        "offset": offset,
        "periods": periods,
        "samples_per_period": samples_per_period,
        "feedforward": feedforward,
    }
    if controller is not None:
        options["controller"] = {"schema": "bodesmith.controller/1", **controller}
    elif feedforward is not None:
        raise InputError("feedforward belongs to a loop, expected a controller with it")
    arrays = {
        "frequency_hz": signal(np.atleast_1d(frequency_hz), "frequency_hz"),
        "amplitude": signal(np.atleast_1d(amplitude), "amplitude"),
    }
    return Sweep(call("sweep", options, arrays, progress).arrays)


class Drive:
    """The drive that makes a model follow a reference.

    Attributes:
        reference, u, predicted: wanted output, drive, and the output that simulate() gives for it; shape (N,) each.
        predicted_error: rms, max, rms_percent_of_range, max_percent_of_range over the settled part, `counted` says which.
        details: out_of_reach, without_inverse, delay_s, drive (its extent) …
    """

    def __init__(self, record: Record, arrays: Mapping[str, FloatArray], details: dict[str, Any], warnings: list[str]) -> None:
        self.reference = record.u
        self.u = arrays["u"]
        self.predicted = arrays["predicted"]
        self.start_s = record.start_s
        self.step_s = record.step_s
        self.predicted_error: dict[str, Any] = details["predicted_error"]
        self.details = details
        self.warnings = warnings

    @property
    def time_s(self) -> FloatArray:
        """Shape (N,), seconds."""
        return self.start_s + self.step_s * np.arange(self.u.size)

    @property
    def record(self) -> Record:
        """The drive as an input."""
        return Record(self.u, step_s=self.step_s, start_s=self.start_s, name="the drive")

    def plot(self, **options: Any) -> Figure:
        """Reference, drive and error over time."""
        return draw(self, **options)

    def __repr__(self) -> str:
        return f"<bodesmith.Drive {self.u.size} samples, predicted rms {self.predicted_error['rms_percent_of_range']:.3g} % of range>"


def compensate(
    model: Model,
    reference: Record | ArrayLike,
    *,
    step_s: float | None = None,
    time_s: ArrayLike | None = None,
    start_s: float = 0.0,
    preview: bool = True,
    start: Literal["equilibrium", "zero"] | None = None,
    lower: float | None = None,
    upper: float | None = None,
    max_rate_per_s: float | None = None,
    bandwidth_hz: float | None = None,
    skip_s: float | None = None,
    progress: Progress | None = None,
) -> Drive:
    """The drive under which the model's output follows a reference, and what error is left.

    Args:
        reference: a Record (its u), or wanted output, shape (N,), with `step_s` or `time_s`.
        preview: look ahead by the model's delays; otherwise the output lags by them.
        start: None: what the model's own `start` says, equilibrium where it has none.
        lower, upper, max_rate_per_s, bandwidth_hz: limits of the drive.
        skip_s: seconds at the start that the stated error does not count.
    """
    record = as_record(reference, step_s, time_s, start_s)
    options = {
        "model": model,
        "step_s": record.step_s,
        "start_s": record.start_s,
        "preview": preview,
        "start": start,
        "lower": lower,
        "upper": upper,
        "max_rate_per_s": max_rate_per_s,
        "bandwidth_hz": bandwidth_hz,
        "skip_s": skip_s,
    }
    answer = call("compensate", options, {"u": record.u}, progress)
    return Drive(record, answer.arrays, answer.result, answer.warnings)


class Identification:
    """A model fitted to records.

    Attributes:
        model: the Model, its table [trained] filled in.
        training, holdout: rms, max, rms_percent_of_range, max_percent_of_range, rms_free_offset; holdout None without records.
        parameters: name, value and (where the records determine it) standard_deviation of each.
        converged: False when the search stopped at its limit.
        notes: what a person must know.
        details: everything that was said.
    """

    def __init__(self, details: dict[str, Any], records: Sequence[Record], warnings: list[str]) -> None:
        self.model = Model.from_text(details.pop("model_text"), _checked=True)
        self.details = details
        self.training: dict[str, float] = details["training"]
        self.holdout: dict[str, float] | None = details.get("holdout")
        self.parameters: list[dict[str, Any]] = details["parameters"]
        self.converged: bool = details["converged"]
        self.notes: list[str] = details["notes"] + details["records"]["notes"]
        self.records = list(records)
        self.warnings = warnings

    def plot(self, **options: Any) -> Figure:
        """Model and first record over time, and the difference."""
        return draw(self, **options)

    def __repr__(self) -> str:
        return f"<bodesmith.Identification {self.details['model']}: {self.training['rms_percent_of_range']:.3g} % of range>"


def _record_list(records: Record | Sequence[Record] | None) -> list[Record]:
    if records is None:
        return []
    return [records] if isinstance(records, Record) else list(records)


def _record_arrays(name: str, records: Sequence[Record], arrays: dict[str, FloatArray]) -> list[dict[str, Any]]:
    for i, record in enumerate(records):
        if record.y is None:
            raise InputError(f"{record.name} has no y")
        arrays[f"u_{name}{i}"] = record.u
        arrays[f"y_{name}{i}"] = record.y
    return [record.about() for record in records]


def identify(
    records: Record | Sequence[Record],
    model: str,
    *,
    holdout: Record | Sequence[Record] | None = None,
    method: Literal["best", "paper"] = "best",
    size: int = 0,
    delay_s: float | Literal["find"] | None = None,
    skip_s: float = 0.0,
    frequency_hz: float = 0.0,
    asymmetric: bool = False,
    effort: float = 1.0,
    seed: int = 1,
    progress: Progress | None = None,
) -> Identification:
    """Fits a hysteresis model to measured records.

    Args:
        records: with y. holdout: not fitted, only compared with.
        model: linear, polynomial_hysteresis, prandtl_ishlinskii, preisach, bouc_wen … (`bodesmith.hysteresis_models()`).
        method: best, or what the model's own paper does.
        size: plays, operators or levels (0: its default).
        delay_s: a pure delay, or "find".
        skip_s: seconds at the start of every record that are not counted.
        frequency_hz: operating frequency for models that ask for it (0: found).
        asymmetric: prandtl_ishlinskii with dead zones. effort: length of stochastic searches, relative.
    """
    training = _record_list(records)
    arrays: dict[str, FloatArray] = {}
    options = {
        "model": model,
        "records": _record_arrays("records", training, arrays),
        "holdout": _record_arrays("holdout", _record_list(holdout), arrays),
        "method": method,
        "size": size,
        "find_delay": delay_s == "find",
        "delay_s": None if delay_s == "find" else delay_s,
        "skip_s": skip_s,
        "frequency_hz": frequency_hz,
        "asymmetric": asymmetric,
        "effort": effort,
        "seed": seed,
    }
    answer = call("identify", options, arrays, progress)
    return Identification(answer.result, training, answer.warnings)


class Comparison:
    """Models fitted to the same records.

    Attributes:
        identifications: Identification by name, those of least error (held out, else training) first.
        refused: why a model could not be fitted, by name.
    """

    def __init__(self, fitted: Mapping[str, Identification], refused: Mapping[str, str]) -> None:
        self.identifications = dict(sorted(fitted.items(), key=lambda one: _score(one[1])))
        self.refused = dict(refused)

    @property
    def best(self) -> Identification:
        """The one of least error."""
        if not self.identifications:
            raise InputError("no model fits these records")
        return next(iter(self.identifications.values()))

    @property
    def table(self) -> list[dict[str, Any]]:
        """A line a model: model, rms and rms_percent_of_range of training and holdout (None without), compute_s."""
        return [
            {
                "model": name,
                "training_rms": one.training["rms"],
                "training_percent": one.training["rms_percent_of_range"],
                "holdout_rms": None if one.holdout is None else one.holdout["rms"],
                "holdout_percent": None if one.holdout is None else one.holdout["rms_percent_of_range"],
                "compute_s": one.details["timing_s"]["compute"],
            }
            for name, one in self.identifications.items()
        ]

    def __str__(self) -> str:
        lines = [f"{'model':<28}{'training %':>12}{'held out %':>12}"]
        for one in self.table:
            held_out = "" if one["holdout_percent"] is None else f"{one['holdout_percent']:.3g}"
            lines.append(f"{one['model']:<28}{one['training_percent']:>12.3g}{held_out:>12}")
        return "\n".join(lines + [f"{name:<28}refused: {why}" for name, why in self.refused.items()])


def _score(one: Identification) -> float:
    return (one.training if one.holdout is None else one.holdout)["rms"]


def compare_models(
    records: Record | Sequence[Record],
    models: Sequence[str] | None = None,
    *,
    holdout: Record | Sequence[Record] | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> Comparison:
    """identify() with several models on the same records, in one table.

    Args:
        models: names (default: linear and all of `bodesmith.hysteresis_models()`).
        options: those of identify(). Start transients are left out with its skip_s, delays found with delay_s="find".
    """
    names = list(models) if models is not None else ["linear", *hysteresis_models()]
    fitted: dict[str, Identification] = {}
    refused: dict[str, str] = {}
    for i, name in enumerate(names):
        try:
            fitted[name] = identify(records, name, holdout=holdout, **options)
        except InputError as error:
            refused[name] = str(error)
        if progress is not None:
            progress((i + 1) / len(names))
    return Comparison(fitted, refused)


def hysteresis_models() -> list[str]:
    """Names that identify() takes, besides "linear"."""
    return call("names").result["models"]


class Diagnosis(Document):
    """What a model is missing (`diagnosis.json`). `files`: model.toml, base_refitted.toml, report.html."""

    _name = "diagnosis"

    @property
    def verdict(self) -> str:
        """explained, partly_explained, nothing_missing, unexplained; or that it was stopped."""
        return self._data["verdict"]

    @property
    def steps(self) -> list[dict[str, Any]]:
        """The effects found, in order: effect, placed, parameters, held-out rms before and after, runner_up, tied_with."""
        return self._data["steps"]

    @property
    def effects(self) -> list[str]:
        """Names of the effects found."""
        return [step["effect"] for step in self.steps]

    @property
    def gap(self) -> dict[str, Any]:
        """initial and final: train_rms, holdout_rms, holdout_percent_of_range."""
        return self._data["gap"]

    @property
    def model(self) -> Model:
        """The base model with what was found."""
        return Model.from_text(self.files["model.toml"])

    def plot(self, **options: Any) -> Figure:
        """The held-out error before, after each step and at the end, and where the model disagreed."""
        return draw(self, **options)

    def _summary(self) -> str:
        return f"{self.verdict}: {', '.join(self.effects) or 'no effect'}"


Measured = Record | FrequencyResponse


def diagnose(
    model: Model,
    data: Measured | Sequence[Measured],
    *,
    holdout: Measured | Sequence[Measured] | None = None,
    max_terms: int = 5,
    threads: int = 2,
    max_seconds: float | None = None,
    seed: int = 1,
    progress: Progress | None = None,
) -> Diagnosis:
    """Names what the model is missing: where it disagrees with measured records, which effect explains it, and how far the
    gap shrinks on records that were not fitted.

    Args:
        data: Records with y, or FrequencyResponses (of one kind). holdout: not fitted, best with another excitation; without
            it 30 % of each record is held out.
        max_terms: largest number of effects to name.
        max_seconds: the best so far is kept after this; the verdict says so.
    """
    arrays: dict[str, FloatArray] = {}
    lists = {"data": _measured_list(data), "holdout": _measured_list(holdout)}
    options: dict[str, Any] = {"model": model, "max_terms": max_terms, "threads": threads, "max_seconds": max_seconds, "seed": seed}
    kinds = {isinstance(one, Record) for group in lists.values() for one in group}
    if len(kinds) != 1:
        raise InputError("expected records, or frequency responses, not both and not none")
    if kinds == {True}:
        for name, group in lists.items():
            options[name] = _record_arrays(name, group, arrays)  # type: ignore[arg-type]
    else:
        for name, group in lists.items():
            options["responses" if name == "data" else "held_out_responses"] = len(group)
            for i, one in enumerate(group):
                arrays[f"frequency_hz_{name}{i}"] = one.frequency_hz  # type: ignore[union-attr]
                arrays[f"response_{name}{i}"] = parts(one.response, "response")  # type: ignore[union-attr]
    return Diagnosis._from(call("diagnose", options, arrays, progress), model, *lists["data"], *lists["holdout"])


def _measured_list(given: Measured | Sequence[Measured] | None) -> list[Measured]:
    if given is None:
        return []
    return [given] if isinstance(given, (Record, FrequencyResponse)) else list(given)
