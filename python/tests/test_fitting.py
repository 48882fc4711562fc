"""fit, approximate, design: against the command line's files and closed forms."""

from __future__ import annotations

import json

import numpy as np
import pytest

import bodesmith as bs
from conftest import assert_same


def test_cascade_is_the_command_lines(points, cascade, example, program, tmp_path):
    program("fit", example / "gains.csv", "-o", "cascade.json")
    written = json.loads((tmp_path / "cascade.json").read_text())
    assert_same(cascade.to_dict(), written)
    assert bs.Cascade.load(tmp_path / "cascade.json").to_dict() == written


def test_a_result_knows_its_files(example, tmp_path, program):
    path = example / "gains.csv"
    program("fit", path, "-o", "cascade.json")
    cascade = bs.fit_cascade(bs.read_points(path))
    cascade.save(tmp_path / "mine.json")
    inputs = json.loads((tmp_path / "cascade.json").read_text())["inputs"]
    assert json.loads((tmp_path / "mine.json").read_text())["inputs"] == inputs
    assert bs.approximate(cascade).to_dict()["inputs"] == inputs
    loaded = bs.Cascade.load(tmp_path / "mine.json")
    assert [one["path"] for one in bs.approximate(loaded).to_dict()["inputs"]] == [str(tmp_path / "mine.json")]
    bs.Sections([(1.0, [], [-1.0])]).save(tmp_path / "hand.json")
    assert json.loads((tmp_path / "hand.json").read_text())["program"] == f"bodesmith {bs.__version__}"


def test_cascade_meets_its_points_and_its_formula(points, cascade):
    got = cascade.response(points.frequency_hz)
    assert np.abs(got[1:]) == pytest.approx(points.gain[1:], rel=1e-12)  # the base is not a condition
    s = 2j * np.pi * points.frequency_hz
    formula = cascade.gain * np.prod(
        [((lam * s + 1) / (x * lam * s + 1)) ** b for lam, x, b in zip(cascade.lambda_s, cascade.x, cascade.beta)], axis=0
    )
    assert got == pytest.approx(formula, rel=1e-12)


def test_points_may_come_in_any_order_and_in_db(points, cascade):
    order = [3, 0, 4, 1, 2]
    again = bs.fit_cascade(points.frequency_hz[order], magnitude_db=points.magnitude_db[order])
    assert again.beta == pytest.approx(cascade.beta, rel=1e-12)


def test_direct_fit_is_the_command_lines(points, example, program, tmp_path):
    program("fit", example / "gains.csv", "--direct", "--order", 2, "--real", "-o", "sections.json")
    sections = bs.fit_direct(points, order=2, real=True)
    assert_same(sections.to_dict(), json.loads((tmp_path / "sections.json").read_text()))
    assert np.all(sections.poles_rad_s.imag == 0)


def test_measured_fit_finds_poles_and_delay():
    f = np.geomspace(1, 1e4, 300)
    s = 2j * np.pi * f
    w, damping, delay = 2 * np.pi * 300, 0.05, 2e-5
    rng = np.random.default_rng(4)
    noise = 1 + 1e-3 * (rng.standard_normal(f.size) + 1j * rng.standard_normal(f.size))
    model = bs.fit_measured(f, np.exp(-s * delay) * w**2 / (s**2 + 2 * damping * w * s + w**2) * noise)
    assert model.report["order"] == 2
    assert np.sort_complex(model.poles_rad_s) == pytest.approx(
        np.sort_complex(np.roots([1, 2 * damping * w, w**2])), rel=2e-3
    )
    assert model.delay_s == pytest.approx(delay, rel=0.02)
    assert bs.fit(bs.FrequencyResponse(f, model.response(f)), kind="measured", order=2).delay_s == pytest.approx(model.delay_s)


def test_waveform_fit_is_the_command_lines(disturbance, example, program, tmp_path):
    program("fit", "--waveform", example / "disturbance.json", "--order", 1, "-o", "sections.json")
    sections = bs.fit_waveform(disturbance, order=1)
    assert_same(sections.to_dict(), json.loads((tmp_path / "sections.json").read_text()))


def test_sections_are_the_command_lines(cascade, sections, program, tmp_path):
    cascade.save(tmp_path / "cascade.json")
    program("approximate", "cascade.json", "--max-error-db", 0.05, "-o", "sections.json")
    assert_same(sections.to_dict(), json.loads((tmp_path / "sections.json").read_text()))
    f = np.geomspace(0.1, 1e3, 400)
    difference = 20 * np.log10(np.abs(sections.response(f) / cascade.response(f)))
    assert np.max(np.abs(difference)) <= sections.error["everywhere_max_magnitude_db"] * (1 + 1e-4)


def test_a_limit_that_is_not_met_is_data():
    with pytest.warns(bs.BodesmithWarning, match="not met"):
        sections = bs.approximate(bs.Cascade([(0.1, 0.1, 0.5)]), max_error_db=1e-6, max_order=2)
    assert sections.report["limit_met"] is False


@pytest.mark.parametrize("order", [1, 4, 7])
def test_butterworth_poles(order):
    sections = bs.design("lowpass", order=order, corner_hz=100.0)
    angles = np.pi * (2 * np.arange(order) + order + 1) / (2 * order)
    wanted = 2 * np.pi * 100 * np.exp(1j * angles)
    assert np.sort_complex(np.round(sections.poles_rad_s, 9)) == pytest.approx(np.sort_complex(np.round(wanted, 9)), rel=1e-12)
    assert np.abs(sections.response([100.0])[0]) == pytest.approx(np.sqrt(0.5), rel=1e-12)


def test_masks_bands_and_equalisers():
    mask = bs.design("bandpass", family="elliptic", pass_hz=(900, 1100), stop_hz=(700, 1400), ripple_db=0.5, stop_db=50)
    gain_db = mask.at([900, 1000, 1100, 700, 1400]).magnitude_db
    assert np.all(gain_db[:3] >= -0.5 - 1e-9) and np.all(gain_db[3:] <= -50 + 1e-9)
    peak = bs.design("peaking", corner_hz=1000.0, gain_db=6.0, q=2.0)
    assert peak.at([1000.0]).magnitude_db[0] == pytest.approx(6.0, abs=1e-12)
    delay = bs.design("delay", delay_s=1e-3, order=3)
    assert delay.at(np.linspace(1, 100, 50)).group_delay_s == pytest.approx(1e-3, rel=1e-3)
    assert delay.response([50.0])[0] == pytest.approx(np.exp(-2j * np.pi * 50 * 1e-3), abs=1e-5)


def test_what_is_made_by_hand_round_trips(tmp_path):
    made = bs.Sections([(2.0, [-10.0], [-100.0, -1000.0]), (3.0, [], [-5 + 7j, -5 - 7j])], gain=0.5)
    made.save(tmp_path / "sections.json")
    again = bs.Sections.load(tmp_path / "sections.json")
    s = 2j * np.pi * np.array([1.0, 30.0])
    formula = 0.5 * 2 * (s + 10) / ((s + 100) * (s + 1000)) * 3 / ((s + 5) ** 2 + 49)
    assert again.response([1.0, 30.0]) == pytest.approx(formula, rel=1e-12)
    assert bs.Cascade([(0.1, 0.5, 0.3)], gain=2.0).response([1e-9])[0] == pytest.approx(2.0)


def test_names():
    assert "minimax" in bs.methods() and "elliptic" in bs.families() and "bouc_wen" in bs.hysteresis_models()
