"""run: a whole project."""

from __future__ import annotations

import os
from typing import Any

from ._call import Progress, call
from .documents import PathLike


def run(project: PathLike, folder: PathLike, *, progress: Progress | None = None) -> dict[str, Any]:
    """Reads a project file, designs, checks and simulates it, and writes every artefact into a folder, as `bodesmith run`.

    Returns the content of run.json; `limits_met` says whether the project's limits are kept.
    """
    return call("run", {"path": os.fspath(project), "folder": os.fspath(folder)}, None, progress).result
