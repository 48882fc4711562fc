"""Results for other programs."""

from __future__ import annotations

import os
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from ._call import FloatArray, call, parts
from .documents import PathLike
from .errors import InputError
from .lti import Sections
from .models import Record
from .responses import FrequencyResponse, band_of, log_grid, response_of


def export(
    thing: Any,
    path: PathLike,
    *,
    format: str | None = None,
    name: str | None = None,
    frequency_hz: ArrayLike | None = None,
    count: int = 200,
    sample_hz: float | None = None,
    method: Literal["tustin", "matched"] = "tustin",
    prewarp_hz: float | None = None,
    single_precision: bool = False,
    signal: Literal["u", "y"] = "u",
) -> list[str]:
    """Writes Touchstone, FRD, MATLAB, PWL, SPICE sources, CSV, python-control and Octave scripts, or digital biquads in C.

    Args:
        thing: Sections (scripts, .mat, biquads), anything with a response (.s1p, .s2p, .frd, .csv, .mat), or a Record (.pwl,
            .inc, .csv, .mat).
        path: the file; its ending chooses the format unless `format` names one of `bodesmith export --help`.
        name: of variables and functions (default: from the path).
        frequency_hz: where a design's response is taken, shape (N,); default: `count` from a decade below to a decade above
            its corners.
        sample_hz, method, prewarp_hz, single_precision: of digital biquads.
        signal: of a Record, where one signal is written.

    Returns what the format says: conventions, errors, what was left out.
    """
    file = os.fspath(path)
    options: dict[str, Any] = {
        "path": file,
        "format": format,
        "name": name or os.path.splitext(os.path.basename(file))[0],
        "sample_hz": sample_hz,
        "method": method,
        "prewarp_hz": prewarp_hz,
        "single_precision": single_precision,
        "signal": signal,
    }
    arrays: dict[str, FloatArray] = {}
    if isinstance(thing, Record):
        options["record"] = thing.about()
        arrays["u"] = thing.u
        if thing.y is not None:
            arrays["y"] = thing.y
    else:
        response = _response(thing, frequency_hz, count)
        arrays = {"frequency_hz": response.frequency_hz, "response": parts(response.response, "response")}
        if isinstance(thing, Sections):
            options["sections"] = thing
    return call("export", options, arrays).result["said"]


def _response(thing: Any, frequency_hz: ArrayLike | None, count: int) -> FrequencyResponse:
    if isinstance(thing, FrequencyResponse):
        if frequency_hz is not None:
            raise InputError("a FrequencyResponse has its own frequencies, expected no frequency_hz")
        return thing
    f = np.asarray(frequency_hz, float) if frequency_hz is not None else log_grid(*band_of([thing]), count)
    return response_of(thing, f)
