from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

version: str

def call(
    name: str,
    options: str,
    arrays: dict[str, NDArray[np.float64]],
    progress: Callable[[float], object] | None,
) -> tuple[str, dict[str, NDArray[np.float64]], dict[str, str], list[str]]: ...
