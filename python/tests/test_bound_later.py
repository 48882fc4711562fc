"""Margins, fractional transfer functions, exporters, sweeps, tables of models, the analog controller, streams and trim: against
the command line's own figures."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest

import bodesmith as bs


def test_margins_are_the_command_lines(program, tmp_path):
    loop = bs.Sections.from_dict(
        {"gain": 1.0, "sections": [{"gain": 4e6, "zeros_rad_s": [], "poles_rad_s": [[-10.0, 0.0], [-2000.0, 0.0]]}]}
    )
    loop.save(tmp_path / "loop.json")
    said = program("bode", "loop.json", "--margins", "--from-hz", 1, "--to-hz", 1e4)["responses"][0]["margins"]
    found = bs.margins(loop, band_hz=(1.0, 1e4))
    assert found.phase_margin_deg == pytest.approx(said["gain_crossings"][0]["phase_margin_deg"], rel=1e-9)
    assert found.max_sensitivity == pytest.approx(said["max_sensitivity"], rel=1e-6)
    assert found.gain_margin_db is None  # two poles never reach -180 degrees
    assert found.closed_loop_stable is True
    # At the crossing the loop's gain is 1.
    assert abs(loop.response([found.phase_margin_hz])[0]) == pytest.approx(1.0, rel=1e-9)
    # Two factors are their product; only of sections alone can stability be told.
    model = bs.Model([{"type": "gain", "gain": 2.0}])
    assert bs.margins(loop, model, band_hz=(1.0, 1e4)).closed_loop_stable is None
    with pytest.raises(bs.InputError):
        bs.margins()


def test_fractional_pid_is_the_command_lines(program, tmp_path):
    (tmp_path / "pid.toml").write_text(
        'schema = "bodesmith.fractional/1"\npid = {kp = 2.0, ki = 12.0, lambda = 0.7, kd = 0.01, mu = 0.6}\n'
    )
    program("approximate", "pid.toml", "--from-hz", 0.5, "--to-hz", 500, "--order", 5, "-o", "s.json")
    written = json.loads((tmp_path / "s.json").read_text())
    mine = bs.approximate_fractional(
        pid={"kp": 2.0, "ki": 12.0, "lambda": 0.7, "kd": 0.01, "mu": 0.6}, band_hz=(0.5, 500.0), order=5
    )
    assert mine.to_dict()["sections"] == written["sections"]
    s = 2j * np.pi * np.geomspace(0.5, 500, 50)
    exact = 2 + 12 * s**-0.7 + 0.01 * s**0.6
    percent = 100 * np.max(np.abs(mine.response(s.imag / (2 * np.pi)) / exact - 1))
    assert percent < 1.0
    kept = bs.approximate_fractional([(1.0, 0.0)], [(1.0, 0.9)], band_hz=(1.0, 100.0), order=3, keep_integrator=True)
    assert kept.to_dict()["approximation"]["poles_at_0"] == 1
    with pytest.raises(bs.DesignError, match="unstable"):
        bs.approximate_fractional([(1.0, 0.0)], [(1.0, 1.0), (-1.0, 0.0)], band_hz=(1.0, 100.0))


def test_exports_are_the_command_lines(sections, program, tmp_path):
    sections.save(tmp_path / "sections.json")
    program("export", "sections.json", "--sample-hz", 48000, "-o", "sections.c")
    said = bs.export(sections, tmp_path / "mine.c", name="sections", sample_hz=48000)
    assert said
    code = [line for line in (tmp_path / "sections.c").read_text().splitlines() if line.strip().startswith("{")]
    assert code and [line for line in (tmp_path / "mine.c").read_text().splitlines() if line.strip().startswith("{")] == code
    bs.export(sections.at(np.geomspace(1, 100, 20)), tmp_path / "r.s2p")
    back = bs.read_response(tmp_path / "r.s2p")
    assert back.response == pytest.approx(sections.response(back.frequency_hz), rel=1e-6)
    record = bs.reference("sine", frequency_hz=5.0, duration_s=0.4)
    bs.export(record, tmp_path / "drive.pwl")
    assert len((tmp_path / "drive.pwl").read_text().split()) == 2 * record.u.size
    with pytest.raises(bs.InputError):
        bs.export(record, tmp_path / "drive.c", sample_hz=1000)


def test_sweep_is_simulate(program, tmp_path):
    model = bs.Model([{"type": "lowpass", "corner_hz": 50.0}])
    table = bs.sweep(model, [5.0, 50.0], [0.5, 1.0], kind="sine", periods=5)
    assert table.frequency_hz.tolist() == [5.0, 5.0, 50.0, 50.0]
    exact = np.array([1 / (1 + 0.1j), 1 / (1 + 0.1j), 1 / (1 + 1j), 1 / (1 + 1j)])
    assert table.gain_db == pytest.approx(20 * np.log10(np.abs(exact)), abs=1e-3)
    assert table.phase_deg == pytest.approx(np.degrees(np.angle(exact)), abs=0.05)
    model.save(tmp_path / "m.toml")
    runs = ["--sweep-frequency-hz", "5,50", "--sweep-amplitude", "0.5,1", "--periods", 5]
    program("simulate", "m.toml", "--reference", "sine", *runs, "-o", "t.csv")
    lines = [line for line in (tmp_path / "t.csv").read_text().splitlines() if not line.startswith("#")]
    rms = [float(row["rms_percent"]) for row in csv.DictReader(lines)]
    assert table.rms_percent == pytest.approx(rms, rel=1e-9)


def test_models_beside_each_other():
    u = bs.reference("triangle", frequency_hz=2.0, duration_s=1.0)
    stage = bs.Model([{"type": "prandtl_ishlinskii", "r": [0.0, 0.1, 0.2], "w": [0.7, 0.2, 0.1]}])
    record = bs.simulate(stage, u).record
    found = bs.compare_models(record, ["linear", "polynomial_hysteresis", "prandtl_ishlinskii"])
    assert found.table[0]["model"] == "prandtl_ishlinskii"
    assert found.best.training["rms"] == min(line["training_rms"] for line in found.table)
    assert found.identifications["linear"].training["rms"] > 5 * found.best.training["rms"]
    assert "prandtl_ishlinskii" in str(found)


def test_controller_is_the_command_lines(disturbance, example, program, tmp_path):
    program("controller", example / "disturbance.json", "--track-hz", 20, "-o", "c")
    mine = bs.controller(disturbance, track_hz=[20.0])
    written = json.loads((tmp_path / "c/controller.json").read_text())
    assert mine.to_dict()["parts"] == written["parts"]
    assert mine.tracking == written["predicted"]
    assert ".subckt controller r v" in mine.netlist
    assert mine.files["bom.csv"] == (tmp_path / "c/bom.csv").read_text()
    mine.write(tmp_path / "mine")
    assert (tmp_path / "mine/controller.kicad_sch").is_file()


def test_streams_are_the_command_lines(plan, board):
    made = bs.streams(bs.Plan.load(board / "plan.json"))
    written = (board / "stream/chip1.ahf").read_text()
    assert made.files["chip1.ahf"] == written
    assert made.bytes_of(1) == bytes(int(line, 16) for line in written.split())
    assert made.details["largest_difference_percent"] < 1e-7
    # A plan of the package has streams as the command's has.
    assert bs.streams(plan).files["chip1.ahf"] == written
    with pytest.raises(bs.InputError):
        bs.streams(plan, pins={"chip1.out1": 9})


def test_trim_brings_a_board_back(plan):
    f = np.geomspace(*plan.error_with_delays["band_hz"], 60)
    response = plan.response(f)
    off = bs.FrequencyResponse(f, response * (1 + 0.02 * f / f[-1]))
    trimmed = bs.trim(plan, off, samples=50)
    said = trimmed.to_dict()["trim"]
    assert isinstance(trimmed, bs.Plan)
    assert said["after"]["median_percent"] <= said["before"]["median_percent"]
    assert trimmed.files["build_sheet.md"]
