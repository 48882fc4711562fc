"""`run --measured`: what examples/bench/bench.py hides (equations of its own, not the program's) is found by the name of a part."""

import csv
import json
import random
import subprocess
import sys

import numpy as np
import pytest
from chip_bytes import board_of
from conftest import ROOT, run

PROJECT = ROOT / "examples/bench/project.toml"
CLOSED_FORM = {"BODESMITH_NGSPICE": "/nowhere"}  # what ngspice makes of a design: test_tracking_limits, docs/jobs/measured.md


def bench(*arguments):
    done = subprocess.run([sys.executable, ROOT / "examples/bench/bench.py", *map(str, arguments)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    folder = tmp_path_factory.mktemp("built")
    done = run("run", PROJECT, "-o", folder, env=CLOSED_FORM)
    assert done.status == 0, done.err
    return folder


def measured(built, file, project=PROJECT):
    done = run("run", project, "--measured", file, "-o", built, "--json", env=CLOSED_FORM)
    assert done.status == 0, done.err
    out = json.loads(done.out)
    assert json.loads((built / "measured/measured.json").read_text())["found"] == out["found"]
    for name in out["files"]:
        assert (built / name).stat().st_size > 0
    return out


@pytest.fixture(scope="module")
def as_meant(built, tmp_path_factory):
    record = tmp_path_factory.mktemp("as_meant") / "record.csv"
    bench("controller", built, "-o", record)
    return record


def test_a_controller_as_it_was_meant_is_not_accused(built, as_meant):
    out = measured(built, as_meant)
    assert out["verdict"] == "nothing_missing" and out["found"] == [] and out["next"] is None
    assert not any(name.startswith("next/") for name in out["files"])


def test_parts_within_their_tolerances_are_not_accused_and_do_not_hide_a_wrong_one(built, tmp_path):
    drawn = random.Random(2)
    off = {}
    for row in csv.DictReader((built / "controller/parts.csv").open()):
        if row["type"] in ("resistor", "capacitor"):
            off[row["part"]] = 1.0 + drawn.uniform(-1, 1) * (0.001 if row["type"] == "resistor" else 0.01)
    bench("controller", built, *(f"{part}={factor}" for part, factor in off.items()), "-o", tmp_path / "good.csv")
    out = measured(built, tmp_path / "good.csv")
    assert out["gap_percent"]["before"] > 3 * out["noise_percent"]
    assert out["found"] == [] and out["next"] is None and "tolerances" in out["advice"]
    off["Rd3"] = 1.08
    bench("controller", built, *(f"{part}={factor}" for part, factor in off.items()), "--amplifier-hz", 50e3, "-o", tmp_path / "wrong.csv")
    out = measured(built, tmp_path / "wrong.csv")
    assert out["of"] == "the controller and the stage"
    assert len(out["found"]) == 2 and out["found"][0].startswith("Rd3 is 8") and out["tied"] == []
    corner = out["found"][1].split()
    assert corner[:3] == ["amplifier:", "corner", "is"] and corner[4] == "kHz" and float(corner[3]) == pytest.approx(50.0, rel=0.1)
    assert out["gap_percent"]["before"] > 2 * out["gap_percent"]["with_what_was_found"]
    tracking = out["next"]["tracking_percent"]
    assert tracking["predicted"] < 0.5 * tracking["before"]
    assert "corner_hz = 100000" not in (built / "next/stage.toml").read_text()
    rows = list(csv.DictReader((built / "measured/comparison.csv").open()))
    assert len(rows) == 901 and set(rows[0]) == {"time_s", "u", "measured", "predicted", "with_what_was_found"}


@pytest.mark.parametrize("stage, words", [
    (("--stage-falling", 1.08), "stage: its curves"),
    (("--resonance-hz", 3e3), "resonance (after block 7, stroke_m)"),
])
def test_a_stage_that_is_another_one(built, tmp_path, stage, words):
    """No part of the controller is accused, and no multiplier where the stage has none."""
    bench("controller", built, *stage, "-o", tmp_path / "record.csv")
    out = measured(built, tmp_path / "record.csv")
    assert len(out["found"]) == 1 and out["found"][0].startswith(words) and out["tied"] == []
    # The noise of the bench is 2e-5 of the stroke.
    assert out["gap_percent"]["with_what_was_found"] == pytest.approx(0.002, rel=0.15)
    # Nothing that was soldered mends it, so nothing is foretold.
    assert "tracking_percent" not in out["next"] and "designed again" in out["next"]["what"][0]
    if "curves" in words:
        assert float(out["found"][0].split("by up to ")[1].split()[7]) == pytest.approx(0.64, rel=0.03)


def test_a_stage_alone_with_another_curve_and_less_lag(built, tmp_path):
    """60 Hz: a delay of 1.6 µs instead of poles and a mode, and a rising curve of its own."""
    disturbance = json.loads((ROOT / "examples/nanopositioner/disturbance.json").read_text())
    t = np.arange(1201) / 400 / 60
    u, v = (1 - np.abs(1 - 2 * (60 * at % 1)) for at in (t, t - 1.6e-6))
    rates = disturbance["rate"]
    falling = np.array(disturbance["descending"]) * rates["descending"][rates["frequency_hz"].index(60)]
    rising = np.array(disturbance["ascending"]) + [0.05, -0.1, 0.05]
    up = 60 * (t - 1.6e-6) % 1 < 0.5
    y = v * (1 + np.where(up, *(a[0] + v * (a[1] + v * a[2]) for a in (rising, falling))))
    y = 6.92e-6 * (y + np.random.default_rng(3).normal(0, 2e-5, len(u)))
    np.savetxt(tmp_path / "stage.csv", np.column_stack([t, u, y]), delimiter=",", header="time_s,u,y", comments="")
    out = measured(built, tmp_path / "stage.csv")
    assert out["of"] == "the stage" and out["tied"] == []
    curves = next(one for one in out["found"] if one.startswith("stage: its curves"))
    assert float(curves.split("by up to ")[1].split()[0]) == pytest.approx(0.05 * 4 / 27 * 100, rel=0.05)
    assert all(one.startswith(("stage: its curves", "amplifier: corner")) for one in out["found"])
    assert any("less of lag" in one for one in out["found"]) and "generator" not in out["advice"]


def test_a_switch_that_acts_late(built, tmp_path):
    """.9 of a sample behind each turn."""
    late_us = 30
    bench("controller", built, "--switch-late-s", late_us * 1e-6, "-o", tmp_path / "record.csv")
    out = measured(built, tmp_path / "record.csv")
    assert [name.split()[0] for name in out["found"]] == ["switch_delay"]
    late = float(out["found"][0].split("Switch delay ")[1].split()[0])
    # The bench switches at one of its own steps, of .52 µs.
    assert late == pytest.approx(late_us, abs=0.5) and "inside block 1" in out["found"][0]
    # The noise of the bench is 2e-5 of the stroke.
    assert out["verdict"] == "explained" and out["gap_percent"]["with_what_was_found"] == pytest.approx(0.002, rel=0.15)


def test_a_capacitor_of_the_circuit_and_parts_within_their_tolerances(built, tmp_path):
    bench("circuit", built, "C1_2=1.08", "-o", tmp_path / "bode.csv")
    out = measured(built, tmp_path / "bode.csv")
    assert out["of"] == "the circuit" and out["found"][0].startswith("C1_2 is 7.3")
    assert out["next"]["response_percent"]["before"] > 10 * out["next"]["response_percent"]["predicted"]
    # Parts as they are ordered: 1 and 5 %.
    draw = random.Random(5)
    parts = [part["part"] for stage in json.loads((built / "spice/circuit.json").read_text())["stages"] for part in stage["parts"]]
    off = [f"{part}={1 + draw.uniform(-1, 1) * (0.01 if part.startswith('R') else 0.05):.6g}" for part in parts]
    bench("circuit", built, *off, "-o", tmp_path / "drawn.csv")
    out = measured(built, tmp_path / "drawn.csv")
    assert out["of"] == "the circuit" and out["verdict"] == "nothing_wrong" and out["found"] == []


def test_resistors_of_which_only_the_ratio_shows_are_a_tie_that_one_part_mends(built, tmp_path):
    bench("circuit", built, "R2_1=1.1", "-o", tmp_path / "bode.csv")
    out = measured(built, tmp_path / "bode.csv")
    assert "R2_1" in out["tied"] and "R1_1" in out["tied"]
    assert out["next"]["response_percent"]["before"] > 5 * out["next"]["response_percent"]["predicted"]
    assert "Rx_" in (built / "next/compensator.sub").read_text()


def test_a_capacitor_of_a_board_beside_a_circuit(tmp_path):
    """What the streams' bytes make of one capacitor a tenth too large, by chip_bytes.py."""
    project = tmp_path / "project.toml"
    hz = np.geomspace(30, 3000, 13)
    gain = 1 / np.abs((1 + 1j * hz / 200) * (1 + 1j * hz / 900)) * np.abs(1 + 1j * hz / 500)
    (tmp_path / "points.csv").write_text("frequency_hz,gain\n" + "".join(f"{f:.6g},{g:.8g}\n" for f, g in zip(hz, gain)))
    project.write_text(
        'schema = "bodesmith.project/1"\nname = "two poles"\n[target]\npoints = "points.csv"\n[fit]\nmax_error_db = 0.01\n'
        "[hardware.fpaa]\nclock_hz = 250e3\n[hardware.circuit]\n"
    )
    out = tmp_path / "out"
    done = run("run", project, "-o", out)
    assert done.status == 0, done.err
    plan = json.loads((out / "fpaa/plan.json").read_text())
    band = plan["error_with_delays"]["band_hz"]
    done = run("fpaa", out / "sections.json", "--from-hz", band[0], "--to-hz", band[1], "--clock-hz", 250e3, "--stream", "-o", tmp_path / "board")
    assert done.status == 0, done.err
    bytes_of = json.loads((tmp_path / "board/plan.json").read_text())
    capacitors = [[cam["capacitors"] for chip in one["chips"] for cam in chip["cams"]] for one in (plan, bytes_of)]
    assert capacitors[0] == capacitors[1]
    plan = bytes_of  # the same board, and its pins
    board = board_of(plan, tmp_path / "board/stream")
    at = np.geomspace(20, 3000, 25)
    noise = random.Random(3)

    def record(name):
        rows = [
            f"{f:.9g},{20 * np.log10(abs(h)) + noise.gauss(0, 0.001):.9g},{np.degrees(np.angle(h)) + noise.gauss(0, 0.01):.9g}"
            for f, h in zip(at, board.gain(at))
        ]
        (tmp_path / name).write_text("frequency_hz,magnitude_db,phase_deg\n" + "\n".join(rows) + "\n")
        return measured(out, tmp_path / name, project)

    good = record("good.csv")
    assert good["of"] == "the board" and good["found"] == [] and good["next"] is None
    assert good["gap_percent"]["before"] < 2 * good["noise_percent"] + 0.02
    units, *rest = board.capacitors[0]
    board.capacitors[0] = (1.1 * units, *rest)
    wrong = record("wrong.csv")
    address, cab = board.cabs[0]
    chip = plan["chips"][sorted(board.chips).index(address)]
    names = [cam["name"] for cam in chip["cams"] if cam["cab"] == cab]
    assert wrong["of"] == "the board" and wrong["found"]
    assert any(name in " ".join(wrong["found"]) for name in names), (names, wrong["found"])
    assert wrong["gap_percent"]["with_what_was_found"] < 0.2 * wrong["gap_percent"]["before"]


def test_bad_input_is_one_line_and_nothing_is_written(built, as_meant, tmp_path):
    before = sorted(built.rglob("*"))
    (tmp_path / "bad.csv").write_text("frequency_hz,magnitude_db\n1,x\n")
    other = tmp_path / "other.toml"
    other.write_text(PROJECT.read_text().replace("../", str(ROOT / "examples") + "/").replace("[1, 100]", "[1, 50]"))
    (tmp_path / "bode.csv").write_text("frequency_hz,magnitude_db\n1,0\n2,0\n3,0\n")
    rows = list(csv.reader(as_meant.open()))
    microns = [rows[0], *((t, u, repr(1e6 * float(y))) for t, u, y in rows[1:])]
    (tmp_path / "microns.csv").write_text("\n".join(",".join(row) for row in microns) + "\n")
    files = [(PROJECT, tmp_path / name) for name in ("bad.csv", "none.csv", "microns.csv")] + [(other, tmp_path / "bode.csv")]
    for project, file in files:
        done = run("run", project, "--measured", file, "-o", built)
        assert done.status == 2 and len(done.err.splitlines()) == 1, done.err
    assert sorted(built.rglob("*")) == before
