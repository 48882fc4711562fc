"""`run`: what is built stands in three columns (closed form, CVODE, ngspice), and [limits] hold tracking and agreement."""

import csv
import json
import shutil

import pytest
from conftest import ROOT, run


def project(folder, limits):
    text = (ROOT / "examples/bench/project.toml").read_text().replace("../", str(ROOT / "examples") + "/")
    (folder / "project.toml").write_text(text + "\n[limits]\n" + limits)
    return folder / "project.toml"


def test_three_rows_say_the_same_and_are_held_to_it(tmp_path):
    ngspice = shutil.which("ngspice") is not None
    file = project(tmp_path, "tracking_percent = 0.05\n" + ("agreement_percent = 0.02\n" if ngspice else ""))
    done = run("run", file, "-o", tmp_path / "out")
    assert done.status == 0, done.out + done.err
    out = json.loads((tmp_path / "out/run.json").read_text())
    rows = {one["key"]: one for one in out["tracking"]["designs"]}
    keys = ["controller_at_rest", "controller_cvode"] + (["controller_circuit"] if ngspice else [])
    # In percent of range; at rest nothing lags, which is the rest of the difference at 100 Hz.
    for a in keys:
        for b in keys:
            for one, other in zip(rows[a]["rms_percent_without_lag"], rows[b]["rms_percent_without_lag"]):
                assert one == pytest.approx(other, abs=0.02)
    assert [key for key in keys if rows[key]["built"]] == keys[-1:]
    assert (out["tracking"]["agreement_percent"] is None) == (not ngspice)
    if ngspice:
        assert out["tracking"]["agreement_percent"] < 0.02
    engines = out["tracking"]["engines"]
    assert len(engines) >= 2
    for one in engines:
        columns = [one[engine + "_percent"] for engine in ("closed_form", "cvode", "ngspice")]
        assert (None in columns) == bool(one["missing"])
        got = [value for value in columns if value is not None]
        assert got and max(got) - min(got) < 0.02 and (len(got) == 1 or 0 < one["agreement_percent"] < 0.05)
    table = list(csv.DictReader((tmp_path / "out/tracking.csv").open()))
    assert {key + "_percent" for key in keys} <= set(table[0])


def test_half_a_stroke_by_amplitude_gains_in_closed_form_too_and_a_limit_that_is_not_met_is_exit_status_1(tmp_path):
    """The closed form took the gains of the full stroke: 7 % of half of one where CVODE and ngspice have .1."""
    (tmp_path / "gains.csv").write_text((ROOT / "examples/nanopositioner/gains.csv").read_text())
    (tmp_path / "d.json").write_text((ROOT / "examples/papers/amplitude_gains.json").read_text())
    (tmp_path / "project.toml").write_text(
        'schema = "bodesmith.project/1"\nname = "half"\n[target]\npoints = "gains.csv"\ndisturbance = "d.json"\nbase_hz = 1.0\n'
        "[approximate]\norder = 1\n[hardware.circuit]\n[plant]\nstroke_m = 7e-6\n[track]\namplitude = 0.5\nfrequency_hz = [100]\n"
        "[limits]\ntracking_percent = 0.001\n"
    )
    done = run("run", tmp_path / "project.toml", "-o", tmp_path / "out", env={"BODESMITH_NGSPICE": "/nowhere"})
    assert done.status == 1 and "limit      tracking_percent 0.001" in done.out and "NOT met" in done.out, done.out + done.err
    controller = json.loads((tmp_path / "out/run.json").read_text())["tracking"]["engines"][0]
    assert controller["cvode_percent"] < 0.1
    assert controller["closed_form_percent"] == pytest.approx(controller["cvode_percent"], abs=0.03)


def test_projects_without_a_stage_do_not_track(tmp_path):
    folder = tmp_path / "mine"
    run("new", folder, "--kind", "filter")
    file = folder / "project.toml"
    file.write_text(file.read_text().replace("[limits]", "[limits]\ntracking_percent = 1.0"))
    done = run("run", file, "-o", tmp_path / "out")
    assert done.status == 2 and "tracking_percent" in done.err and len(done.err.splitlines()) == 1
