"""What is given wrongly is an exception that says where."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import bodesmith as bs


def test_file_and_line(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("frequency_hz,gain\n1,1\n2,-3\n")
    with pytest.raises(bs.InputError) as caught:
        bs.read_points(path)
    assert (caught.value.file, caught.value.line) == (str(path), 3)
    assert str(caught.value).startswith(f"{path}:3: ")
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.line, str(again)) == (3, str(caught.value))


def test_a_bad_document_names_its_place(tmp_path):
    path = tmp_path / "sections.json"
    path.write_text('{"schema": "bodesmith.sections/1",\n "gain": 1,\n "sections": [{"gain": 1, "zeros_rad_s": [], "poles_rad_s": [[3, 0]]}]}')
    with pytest.raises(bs.InputError) as caught:
        bs.Sections.load(path)
    assert caught.value.line == 3
    with pytest.raises(bs.InputError, match=r"^'sections\[0\]") as caught:
        bs.Sections([(1.0, [], [3.0])])
    assert caught.value.file is None and caught.value.line is None


def test_a_bad_model_names_its_line(tmp_path):
    path = tmp_path / "model.toml"
    path.write_text('schema = "bodesmith.model/1"\n[[block]]\ntype = "lowpass"\ncorner_hz = -1\n')
    with pytest.raises(bs.InputError) as caught:
        bs.Model.load(path)
    assert caught.value.line == 4
    with pytest.raises(bs.InputError, match="corner_hz"):
        bs.Model([{"type": "lowpass", "corner_hz": -1.0}])


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: bs.fit_cascade([1, 2, 3], [1, 2]),
        lambda: bs.fit_cascade([1, 2, 2], [1, 2, 3]),
        lambda: bs.fit_cascade([1, 2, 3], [1, np.nan, 3]),
        lambda: bs.fit_cascade([1, 2], [1, 2], beta_max=np.inf),
        lambda: bs.fit_cascade([1, 2], ["a", "b"]),
        lambda: bs.fit_cascade([[1, 2]], [[1, 2]]),
        lambda: bs.fit_cascade([1, 2], [1, 2], magnitude_db=[1, 2]),
        lambda: bs.fit_direct([1, 2], [1, 2]),
        lambda: bs.fit([1, 2], [1, 2], kind="other"),
        lambda: bs.design("lowpass", order=3),
        lambda: bs.design("lowpass", order=3, corner_hz=1.0, pass_hz=2.0, stop_hz=3.0),
        lambda: bs.Record([1, 2, 3]),
        lambda: bs.Record([1, 2, 3], time_s=[0, 1, 3]),
        lambda: bs.simulate(bs.Model([{"type": "gain", "gain": 1}]), [1, np.nan], step_s=1.0),
        lambda: bs.simulate(bs.Model([{"type": "gain", "gain": 1}]), [1, 2], step_s=1.0, engine="other"),
        lambda: bs.Model([{"type": "saturation", "lower": 0, "upper": 1}]).response([1.0]),
        lambda: bs.identify(bs.Record([1, 2, 3], step_s=1.0), "linear"),
        lambda: bs.yield_([]),
        lambda: bs.bode(),
        lambda: bs.read_record("/no/such/file.csv"),
    ],
)
def test_input_errors(wrong):
    with pytest.raises(bs.InputError):
        wrong()


def test_a_design_that_does_not_fit():
    slow = bs.design("lowpass", order=1, corner_hz=1e-6)
    with pytest.raises(bs.DesignError):
        bs.spice(slow)


def test_nothing_is_written_over_by_halves(tmp_path):
    sections = bs.design("lowpass", order=1, corner_hz=1.0)
    with pytest.raises(bs.InputError):
        sections.save(tmp_path / "no" / "such" / "\0")
    with pytest.raises(bs.InputError):
        sections.save("/dev/full")


def test_the_names_that_are_needed_are_said(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "control", None)
    with pytest.raises(ImportError, match="python-control"):
        bs.design("lowpass", order=1, corner_hz=1.0).to_control()
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
    with pytest.raises(ImportError, match="matplotlib"):
        bs.plot_bode(bs.design("lowpass", order=1, corner_hz=1.0))
