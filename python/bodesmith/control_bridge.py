"""To python-control, where it is installed."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._call import ComplexArray, FloatArray


def control_module() -> Any:
    try:
        import control
    except ImportError as error:
        raise ImportError("to_control() and to_frd() need python-control: pip install control") from error
    return control


def frd(frequency_hz: FloatArray, response: ComplexArray) -> Any:
    return control_module().FrequencyResponseData(response, 2.0 * np.pi * frequency_hz)


def section_state_space(gain: float, zeros: ComplexArray, poles: ComplexArray) -> tuple[NDArray[np.float64], ...]:
    """gain Π(s − z)/Π(s − p) as A, B, C, D, time scaled by the poles' own frequency (entries near it, not its square)."""
    order = len(poles)
    w = float(np.exp(np.mean(np.log(np.abs(poles))))) if np.all(poles != 0) else 1.0
    denominator = np.real(np.poly(poles / w))
    numerator = np.zeros(order + 1)
    numerator[order - len(zeros) :] = np.atleast_1d(np.real(np.poly(zeros / w)))
    numerator *= gain * w ** (len(zeros) - order)
    direct = numerator[0]
    a = np.zeros((order, order))
    a[0, :] = -denominator[1:]
    a[1:, :-1] += np.eye(order - 1)
    b = np.zeros((order, 1))
    b[0, 0] = 1.0
    c = (numerator[1:] - direct * denominator[1:]).reshape(1, order)
    return w * a, w * b, c, np.array([[direct]])


def series(first: tuple[NDArray[np.float64], ...], second: tuple[NDArray[np.float64], ...]) -> tuple[NDArray[np.float64], ...]:
    """The second system behind the first."""
    a1, b1, c1, d1 = first
    a2, b2, c2, d2 = second
    a = np.block([[a1, np.zeros((a1.shape[0], a2.shape[0]))], [b2 @ c1, a2]])
    return a, np.vstack([b1, b2 @ d1]), np.hstack([d2 @ c1, c2]), d2 @ d1
