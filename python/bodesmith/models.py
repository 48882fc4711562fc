"""Models of a stage (blocks in series), disturbances, records."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ._call import ComplexArray, FloatArray, call, plain, signal
from .documents import Document, PathLike, origin_of
from .errors import InputError
from .responses import FrequencyResponse, response_of


class Model(Document):
    """Blocks in series, input first: `model.toml`.

    Args:
        blocks: a mapping each, `{"type": "lowpass", "corner_hz": 100.0, "free": ["corner_hz"]}`; types and parameters are
            those of docs (gain, lowpass, pole_zero, resonator, delay, saturation, polynomial_hysteresis, …), frequencies in
            Hz, times in s. `free` names what identify and diagnose may refit.
    """

    _name = "model"
    _file = "model.toml"

    def __init__(self, blocks: Iterable[Mapping[str, Any]] = ()) -> None:
        made = Model.from_dict({"block": [dict(block) for block in blocks]})
        super().__init__(made._data)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Model:
        data = plain(data, "")
        data.setdefault("schema", "bodesmith.model/1")
        return cls._read("check_document", {"schema": "model", "document": data})

    @classmethod
    def load(cls, path: PathLike) -> Model:
        """Reads a model.toml. Raises InputError with `.file` and `.line`."""
        out = cls._read("read_document", {"schema": "model", "path": os.fspath(path)})
        with open(path, "rb") as file:
            out.origins = [origin_of(path, file.read())]
        return out

    @classmethod
    def _read(cls, name: str, options: dict[str, Any]) -> Model:
        return cls.from_text(call(name, options).result["text"], _checked=True)

    @classmethod
    def from_text(cls, text: str, *, _checked: bool = False) -> Model:
        """From the text of a model.toml."""
        data = tomllib.loads(text)
        return cls._of(data) if _checked else cls.from_dict(data)

    def save(self, path: PathLike) -> None:
        """Writes model.toml, whole or not at all."""
        folder, name = os.path.split(os.path.abspath(os.fspath(path)))
        call("write_files", {"folder": folder, "files": {name: self._text()}})

    def _text(self) -> str:
        return call("check_document", {"schema": "model", "document": self._data}).result["text"]

    @property
    def blocks(self) -> list[dict[str, Any]]:
        return self.to_dict().get("block", [])

    @property
    def trained(self) -> dict[str, Any] | None:
        """What the model was fitted to, and how well; None where it was not."""
        return self.to_dict().get("trained")

    def response(self, frequency_hz: ArrayLike) -> ComplexArray:
        """H(j 2π f) of a model of linear blocks, complex, shape (N,). InputError names a block that is not linear."""
        return response_of(self, frequency_hz).response

    def at(self, frequency_hz: ArrayLike) -> FrequencyResponse:
        """The same with magnitude in dB and phase in degrees."""
        return response_of(self, frequency_hz)

    def _summary(self) -> str:
        return " → ".join(block["type"] for block in self.blocks) or "no block"


class Disturbance(Document):
    """The hysteretic disturbance of a piezo stage,

        d(x) = a1 x + a2 x² + a3 x³,   x in [0, 1],

    with other coefficients while x rises than while it falls, and gain tables over amplitude and operating frequency.

    Args:
        ascending, descending: (a1, a2, a3).
        rate: {"frequency_hz": …, "ascending": …, "descending": …}, gains relative to the lowest frequency.
        amplitude: {"alpha": …, "ascending": …, "descending": …}, gains relative to full stroke.
    """

    _name = "disturbance"

    def __init__(
        self,
        ascending: ArrayLike,
        descending: ArrayLike,
        *,
        rate: Mapping[str, ArrayLike] | None = None,
        amplitude: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        data: dict[str, Any] = {"ascending": np.asarray(ascending, float), "descending": np.asarray(descending, float)}
        if amplitude is not None:
            data["amplitude"] = {key: np.asarray(values, float) for key, values in amplitude.items()}
        if rate is not None:
            data["rate"] = {key: np.asarray(values, float) for key, values in rate.items()}
        super().__init__(Disturbance.from_dict(data)._data)

    @property
    def ascending(self) -> FloatArray:
        """(a1, a2, a3) while x rises."""
        return np.array(self._data["ascending"], dtype=float)

    @property
    def descending(self) -> FloatArray:
        """(a1, a2, a3) while x falls."""
        return np.array(self._data["descending"], dtype=float)

    def value(self, x: ArrayLike, *, rising: bool = True) -> FloatArray:
        """d(x) of one branch, without the gain tables; the shape of x."""
        a1, a2, a3 = self.ascending if rising else self.descending
        at = np.asarray(x, dtype=float)
        return at * (a1 + at * (a2 + at * a3))

    def model(self) -> Model:
        """y = u + d(u), branch by the sign of the input's slope; without the gain tables."""
        return Model([{"type": "polynomial_hysteresis", "ascending": self.ascending, "descending": self.descending}])

    def _summary(self) -> str:
        return f"ascending {self.ascending}, descending {self.descending}"


class Record:
    """A uniformly sampled record.

    Args:
        u: input, shape (N,).
        y: output, shape (N,); None for an input only.
        step_s: time between samples; or
        time_s: the times, shape (N,); a jitter over 1 % of the step is an InputError that names the sample.
        start_s: time of the first sample (with step_s).
        name: in messages.
    """

    def __init__(
        self,
        u: ArrayLike,
        y: ArrayLike | None = None,
        *,
        step_s: float | None = None,
        time_s: ArrayLike | None = None,
        start_s: float = 0.0,
        name: str = "the record",
    ) -> None:
        self.u: FloatArray = signal(u, "u")
        self.y: FloatArray | None = None if y is None else signal(y, "y")
        self.name = name
        self.origins: list[dict[str, str]] = []
        if (step_s is None) == (time_s is None):
            raise InputError("expected either step_s or time_s")
        if time_s is not None:
            start_s, step_s = _uniform(signal(time_s, "time_s"), self.u.size)
        assert step_s is not None
        if not step_s > 0.0:
            raise InputError(f"step_s is {step_s}, expected above 0")
        self.start_s = float(start_s)
        self.step_s = float(step_s)
        if self.y is not None and self.y.size != self.u.size:
            raise InputError(f"y has {self.y.size} values, expected {self.u.size}")

    @property
    def time_s(self) -> FloatArray:
        """Shape (N,), seconds."""
        return self.start_s + self.step_s * np.arange(self.u.size)

    def about(self) -> dict[str, Any]:
        """What the library asks for in addition to the samples."""
        return {"name": self.name, "step_s": self.step_s, "start_s": self.start_s}

    def __len__(self) -> int:
        return self.u.size

    def __repr__(self) -> str:
        kind = "u" if self.y is None else "u, y"
        return f"<bodesmith.Record {kind}: {len(self)} samples, {self.step_s:g} s apart>"


def _uniform(time_s: FloatArray, size: int) -> tuple[float, float]:
    if time_s.size != size:
        raise InputError(f"time_s has {time_s.size} values, expected {size}")
    if size < 2:
        raise InputError("a record of fewer than two samples has no step")
    step = float((time_s[-1] - time_s[0]) / (size - 1))
    off = np.abs(time_s - (time_s[0] + step * np.arange(size)))
    worst = int(np.argmax(off))
    if not step > 0.0 or not off[worst] <= 0.01 * step:
        raise InputError(f"time_s[{worst}] is {time_s[worst]}, expected times that rise evenly (within 1 % of the step)")
    return float(time_s[0]), step


def as_record(u: Record | ArrayLike, step_s: float | None, time_s: ArrayLike | None, start_s: float = 0.0) -> Record:
    if isinstance(u, Record):
        if step_s is not None or time_s is not None:
            raise InputError("a Record has its own times, expected neither step_s nor time_s")
        return u
    return Record(u, step_s=step_s, time_s=time_s, start_s=start_s)


def read_record(path: PathLike, column: str = "u") -> Record:
    """A time record: CSV `time_s,u,y` (y may be absent), or any foreign format that the program reads.

    Raises InputError with `.file` and `.line` (a gap, a jitter over 1 % of the step, a value that is no number).

    Args:
        column: the input's column (a reference has `r`).
    """
    answer = call("read_record", {"path": os.fspath(path), "column": column})
    about = answer.result
    out = Record(answer.arrays["u"], answer.arrays.get("y"), step_s=about["step_s"], start_s=about["start_s"], name=about["name"])
    out.origins = about["inputs"]
    return out


def reference(
    kind: str = "triangle",
    *,
    frequency_hz: float = 1.0,
    amplitude: float = 0.5,
    offset: float | None = None,
    duration_s: float = 1.0,
    step_s: float = 1e-3,
    last_hz: float = 100.0,
    steps: int = 10,
    seed: int = 1,
) -> Record:
    """A reference for simulation and experiment.

    Args:
        kind: triangle, sine, stair, multisine, chirp or complex.
        frequency_hz: of a period; of a chirp's or multisine's lowest end, `last_hz` of its highest.
        amplitude, offset: values run from offset − amplitude to offset + amplitude; default offset: the amplitude.
        steps: levels of a stair.
        seed: of a multisine's phases.
    """
    options = {
        "kind": kind,
        "frequency_hz": frequency_hz,
        "amplitude": amplitude,
        "offset": offset,
        "duration_s": duration_s,
        "step_s": step_s,
        "last_hz": last_hz,
        "steps": steps,
        "seed": seed,
    }
    answer = call("reference", options)
    return Record(answer.arrays["u"], step_s=answer.result["step_s"], start_s=answer.result["start_s"], name=kind)
