"""A host that sets a locale (decimal commas, a Turkish i) gets the same numbers and the same bytes."""

from __future__ import annotations

import locale
import pathlib
import re

import numpy as np
import pytest

import bodesmith as bs

POINTS = "Frequency (KHZ);GAIN (DB)\n0,1;-1,5\n1;-3,25\n10;-20,5\n"
TOUCHSTONE = "! one port\n# mhz s db r 50\n0.1 -1.5 -10.5\n0.2 -3.25 -20.25\n"
INCLUDED = ".SUBCKT PART IN OUT\nRI IN OUT 1.5K\n.ENDS\n"
DECK = "T\n.INCLUDE PART.INC\nVIN IN 0 AC 1\nXI IN OUT PART\nC1 OUT 0 0.1U\n.END\n"
PROJECT = """schema = "bodesmith.project/1"
[target]
points = "gains.csv"
disturbance = "disturbance.json"
[hardware.circuit]
[plant]
stroke_m = 6.5e-6
[track]
frequency_hz = [1.0, 15.5]
"""


@pytest.fixture(params=["de_DE.UTF-8", "tr_TR.UTF-8"])
def elsewhere(request):
    """Sets the locale of the process when it is called."""
    before = locale.setlocale(locale.LC_ALL)
    try:
        locale.setlocale(locale.LC_ALL, request.param)
    except locale.Error:
        pytest.skip(f"the locale {request.param} is not installed")
    locale.setlocale(locale.LC_ALL, before)
    yield lambda: locale.setlocale(locale.LC_ALL, request.param)
    locale.setlocale(locale.LC_ALL, before)


def made_files(folder: pathlib.Path) -> dict[str, bytes]:
    """Of every file its bytes, without what tells the time."""
    timing = re.compile(rb'"(timing_s|wall_s|ngspice_s|compute|seconds)": *(\{[^}]*\}|[-+.0-9e]+)')
    return {str(file.relative_to(folder)): timing.sub(b"time", file.read_bytes()) for file in sorted(folder.rglob("*")) if file.is_file()}


def untimed(document: dict[str, object]) -> dict[str, object]:
    return {key: value for key, value in document.items() if key not in ("inputs", "timing_s")}


def everything(inputs: pathlib.Path, out: pathlib.Path) -> tuple[list[object], dict[str, bytes]]:
    """Readers of all kinds and, by the example's curve, all that is written."""
    points = bs.read_points(inputs / "points.csv")
    response = bs.read_response(inputs / "one.s1p")
    model = bs.Model.load(inputs / "model.toml")
    cascade = bs.fit_cascade(bs.read_points(inputs / "gains.csv"))
    sections = bs.approximate(cascade, max_error_db=0.05)
    bs.run(inputs / "project.toml", out / "run")
    bs.export(sections, out / "sections.c", sample_hz=1e5)
    record = bs.reference("sine", frequency_hz=1.5)
    said: list[object] = [
        points.frequency_hz.tolist(),
        points.gain.tolist(),
        response.frequency_hz.tolist(),
        np.asarray(response.response).tolist(),
        untimed(cascade.to_dict()),
        untimed(sections.to_dict()),
        np.asarray(bs.simulate(model, record).y).tolist(),
    ]
    return said, made_files(out)


def test_same_numbers_and_bytes(elsewhere, example, tmp_path):
    for name in ("gains.csv", "disturbance.json"):
        (tmp_path / name).write_bytes((example / name).read_bytes())
    (tmp_path / "points.csv").write_text(POINTS)
    (tmp_path / "one.s1p").write_text(TOUCHSTONE)
    (tmp_path / "project.toml").write_text(PROJECT)
    (tmp_path / "model.toml").write_text('schema = "bodesmith.model/1"\n[[block]]\ntype = "lowpass"\ncorner_hz = 40.25\n')
    here = everything(tmp_path, tmp_path / "here")
    elsewhere()
    there = everything(tmp_path, tmp_path / "there")
    assert here[0] == there[0]
    assert here[1].keys() == there[1].keys()
    for name, written in here[1].items():
        assert written == there[1][name], name


def test_netlists_are_read_and_refused_alike(elsewhere, tmp_path):
    (tmp_path / "PART.INC").write_text(INCLUDED)
    (tmp_path / "deck.cir").write_text(DECK)
    (tmp_path / "outside.cir").write_text(DECK.replace("PART.INC", "../PART.INC"))
    (tmp_path / "command.sub").write_text(INCLUDED + ".CONTROL\nSHELL LS\n.ENDC\n")
    elsewhere()
    for name, said in (("outside.cir", "expected a file in its own folder"), ("command.sub", "control section")):
        with pytest.raises(bs.InputError, match=said):
            bs.response_of(tmp_path / name, [1000.0])
    try:
        found = bs.response_of(tmp_path / "deck.cir", [1000.0])
    except bs.InputError as error:
        assert "ngspice, which is not installed" in str(error)
        return
    assert abs(found.response[0] - 1.0 / (1.0 + 2j * np.pi * 1000.0 * 1.5e3 * 0.1e-6)) < 1e-6

