"""simulate, compensate, identify, diagnose: against closed forms and the command line."""

from __future__ import annotations

import json

import numpy as np
import pytest

import bodesmith as bs

LOWPASS = bs.Model([{"type": "lowpass", "corner_hz": 10.0}])


def write_csv(path, **columns):
    header = ",".join(columns)
    np.savetxt(path, np.column_stack(list(columns.values())), fmt="%.17g", delimiter=",", header=header, comments="")


@pytest.mark.parametrize("engine", ["automatic", "exact", "record", "cvode"])
def test_ramp_through_a_lowpass(engine):
    t = np.arange(201) * 1e-3
    run = bs.simulate(LOWPASS, t, step_s=1e-3, engine=engine)
    tau = 1 / (2 * np.pi * 10)
    assert run.y == pytest.approx(t - tau * (1 - np.exp(-t / tau)), abs=1e-8)
    assert run.error_estimate < 1e-6
    assert run.time_s == pytest.approx(t)


def test_simulation_is_the_command_lines(program, tmp_path):
    model = bs.Model([{"type": "polynomial_hysteresis", "ascending": [0.35, -0.64, 0.29], "descending": [-0.24, 0.08, 0.16]},
                      {"type": "lowpass", "corner_hz": 200.0}])
    model.save(tmp_path / "model.toml")
    assert bs.Model.load(tmp_path / "model.toml").blocks == model.blocks
    u = bs.reference("triangle", frequency_hz=10.0, duration_s=0.2, step_s=1e-3)
    write_csv(tmp_path / "u.csv", time_s=u.time_s, u=u.u)
    program("simulate", "model.toml", "--input", "u.csv", "-o", "y.csv")
    assert bs.simulate(model, u).y == pytest.approx(bs.read_record(tmp_path / "y.csv").y, abs=1e-14)


def test_loop_follows_its_reference():
    t = np.arange(2000) * 1e-3
    run = bs.simulate(LOWPASS, np.ones(t.size), step_s=1e-3, controller={"type": "pi", "kp": 1.0, "ki_per_s": 60.0})
    assert run.y[-1] == pytest.approx(1.0, abs=1e-6)
    assert run.drive is not None and run.drive.shape == t.shape
    ahead = bs.simulate(LOWPASS, t, step_s=1e-3, controller={"type": "pi", "ki_per_s": 1.0}, feedforward=t)
    assert ahead.drive[0] == 0.0


def test_arrays_are_not_copied():
    u = np.zeros(1000)
    record = bs.Record(u, step_s=1e-3)
    assert np.shares_memory(record.u, u)
    y = bs.simulate(LOWPASS, record, engine="record", estimate_error=False).y
    assert not y.flags.owndata and y.flags.writeable  # the library's own memory


def test_compensation_inverts():
    model = bs.Model([{"type": "polynomial_hysteresis", "ascending": [0.35, -0.64, 0.29], "descending": [-0.24, 0.08, 0.16]}])
    wanted = bs.reference("triangle", frequency_hz=5.0, duration_s=0.4, step_s=1e-3)
    drive = bs.compensate(model, wanted)
    assert drive.predicted_error["rms_percent_of_range"] < 0.1
    again = bs.simulate(model, drive.record, start="equilibrium")
    assert again.y == pytest.approx(drive.predicted, abs=1e-12)
    limited = bs.compensate(LOWPASS, wanted, lower=0.0, upper=0.8)
    assert limited.u.max() <= 0.8


def test_identification_is_the_command_lines(program, tmp_path):
    u = bs.reference("sine", frequency_hz=1.0, duration_s=2.0, step_s=2e-3)
    truth = bs.Model([{"type": "gain", "gain": 6.0, "offset": 0.1},
                      {"type": "polynomial_hysteresis", "ascending": [0.2, -0.3, 0.1], "descending": [-0.1, 0.0, 0.1]}])
    y = bs.simulate(truth, u, start="equilibrium").y
    write_csv(tmp_path / "train.csv", time_s=u.time_s, u=u.u, y=y)
    summary = program("identify", "train.csv", "--model", "prandtl_ishlinskii", "-o", "model.toml")
    found = bs.identify(bs.read_record(tmp_path / "train.csv"), "prandtl_ishlinskii")
    assert found.training == summary["training"]
    assert found.model.blocks == bs.Model.load(tmp_path / "model.toml").blocks
    assert found.model.trained["training_rms"] == pytest.approx(summary["training"]["rms"])


def test_diagnosis_names_what_is_missing(tmp_path):
    rng = np.random.default_rng(1)
    u = bs.reference("multisine", frequency_hz=1.0, last_hz=60.0, duration_s=2.0, step_s=2e-3)
    full = bs.Model([{"type": "gain", "gain": 2.0}, {"type": "lowpass", "corner_hz": 25.0}])
    y = bs.simulate(full, u).y + 1e-4 * rng.standard_normal(len(u))
    base = bs.Model([{"type": "gain", "gain": 2.0, "free": ["gain"]}])
    told = []
    found = bs.diagnose(base, bs.Record(u.u, y, step_s=u.step_s), max_terms=1, progress=told.append)
    assert found.verdict == "explained" and found.effects == ["amplifier_pole"]
    assert found.steps[0]["parameters"]["corner_hz"]["value"] == pytest.approx(25.0, rel=0.01)
    assert "lowpass" in [block["type"] for block in found.model.blocks]
    assert told == sorted(told) and all(0.0 <= one <= 1.0 for one in told)
    found.write(tmp_path)
    assert (tmp_path / "report.html").read_text().startswith("<!")
    assert json.loads((tmp_path / "diagnosis.json").read_text())["verdict"] == "explained"


def test_diagnosis_of_a_frequency_response():
    f = np.geomspace(1, 1e3, 60)
    missing = 1 / (1 + 1j * f / 80.0)
    found = bs.diagnose(bs.Model([{"type": "gain", "gain": 1.0, "free": ["gain"]}]), bs.FrequencyResponse(f, missing), max_terms=1)
    assert found.effects == ["amplifier_pole"]
