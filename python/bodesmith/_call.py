"""The one way from Python into the library: options as JSON, signals as numpy arrays that are not copied."""

from __future__ import annotations

import json
import math
import os
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .errors import BodesmithWarning, InputError

Progress = Callable[[float], object]
"""Called now and then, in the thread that called, with the fraction done (0 to 1). What it raises ends the work."""
FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass
class Answer:
    result: dict[str, Any]
    arrays: dict[str, FloatArray]
    files: dict[str, str]
    warnings: list[str]


def plain(value: Any, name: str) -> Any:
    """The value as JSON has it; not-a-number is refused by name."""
    if isinstance(value, Mapping):
        return {str(k): plain(v, f"{name}.{k}" if name else str(k)) for k, v in value.items() if v is not None}
    if hasattr(value, "to_dict"):
        return plain(value.to_dict(), name)
    if isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, np.generic):
        return plain(value.item(), name)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise InputError(f"{name} is {value}, expected a finite number")
        return value
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(one, f"{name}[{i}]") for i, one in enumerate(value)]
    raise InputError(f"{name} is a {type(value).__name__}, expected a number, a word or a list")


def signal(values: ArrayLike, name: str) -> FloatArray:
    """float64, one axis, contiguous; itself when it is that already."""
    try:
        out = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is not an array of real numbers: {error}") from None
    if out.ndim != 1:
        raise InputError(f"{name} has {out.ndim} axes, expected one")
    return out


def parts(values: ArrayLike, name: str) -> FloatArray:
    """Complex values as (re, im, re, im, …), without copying."""
    try:
        out = np.ascontiguousarray(values, dtype=np.complex128)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is not an array of complex numbers: {error}") from None
    if out.ndim != 1:
        raise InputError(f"{name} has {out.ndim} axes, expected one")
    return out.view(np.float64)


def call(
    name: str,
    options: Mapping[str, Any] | None = None,
    arrays: Mapping[str, FloatArray] | None = None,
    progress: Progress | None = None,
) -> Answer:
    text = json.dumps(plain(options or {}, ""))
    result, out, files, said = _core.call(name, text, dict(arrays or {}), progress)
    for one in said:
        warnings.warn(one, BodesmithWarning, stacklevel=3)
    return Answer(json.loads(result), out, files, said)
