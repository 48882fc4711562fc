"""What the tests share: the program next to the package, the example's files, and folders of their own."""

from __future__ import annotations

import importlib.util
import json
import os
import pathlib
import subprocess
from collections.abc import Callable
from typing import Any

import pytest
import stand_in_matplotlib

import bodesmith as bs

ROOT = pathlib.Path(__file__).resolve().parents[2]

if importlib.util.find_spec("matplotlib") is None:
    stand_in_matplotlib.install()


@pytest.fixture(scope="session")
def example() -> pathlib.Path:
    return ROOT / "examples/nanopositioner"


def run_program(folder: pathlib.Path, *arguments: object) -> dict[str, Any]:
    path = os.environ.get("BODESMITH_PROGRAM", str(ROOT / "build/bin/bodesmith"))
    done = subprocess.run([path, *map(str, arguments), "--json"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture
def program(tmp_path: pathlib.Path) -> Callable[..., dict[str, Any]]:
    """Runs the program in tmp_path; its --json summary."""
    return lambda *arguments: run_program(tmp_path, *arguments)


@pytest.fixture(scope="session")
def points(example: pathlib.Path) -> bs.BodePoints:
    return bs.read_points(example / "gains.csv")


@pytest.fixture(scope="session")
def disturbance(example: pathlib.Path) -> bs.Disturbance:
    return bs.Disturbance.load(example / "disturbance.json")


@pytest.fixture(scope="session")
def cascade(points: bs.BodePoints) -> bs.Cascade:
    return bs.fit_cascade(points)


@pytest.fixture(scope="session")
def sections(cascade: bs.Cascade) -> bs.Sections:
    return bs.approximate(cascade, max_error_db=0.05)


@pytest.fixture(scope="session")
def plan(sections: bs.Sections) -> bs.Plan:
    return bs.fpaa(sections, clock_hz=2000.0)  # which spares the search of clocks


@pytest.fixture(scope="session")
def board(sections: bs.Sections, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """The folder that the command writes of the same plan, with its streams."""
    folder = tmp_path_factory.mktemp("board")
    sections.save(folder / "sections.json")
    run_program(folder, "fpaa", "sections.json", "--clock-hz", 2000, "--stream", "-o", "fpaa")
    return folder / "fpaa"


def assert_same(mine: dict[str, Any], written: dict[str, Any]) -> None:
    """All that a call says stands in the command's file, to the last bit; inputs and times apart."""
    for key, value in mine.items():
        if key not in ("inputs", "timing_s"):
            assert written[key] == value, key
