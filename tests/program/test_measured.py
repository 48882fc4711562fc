"""`run --measured`: what examples/bench/bench.py hides (equations of its own, not the program's) is found by the name of a part."""

import csv
import json
import random
import subprocess
import sys

import pytest
from conftest import ROOT, run

PROJECT = ROOT / "examples/bench/project.toml"


def bench(*arguments):
    done = subprocess.run([sys.executable, ROOT / "examples/bench/bench.py", *map(str, arguments)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    folder = tmp_path_factory.mktemp("built")
    done = run("run", PROJECT, "-o", folder)
    assert done.status == 0, done.err
    return folder


def measured(built, file):
    done = run("run", PROJECT, "--measured", file, "-o", built, "--json")
    assert done.status == 0, done.err
    out = json.loads(done.out)
    assert json.loads((built / "measured/measured.json").read_text())["found"] == out["found"]
    for name in out["files"]:
        assert (built / name).stat().st_size > 0
    return out


def test_a_wrong_resistor_and_a_slow_amplifier_of_a_controller(built, tmp_path):
    bench("controller", built, "Rd3=1.08", "--amplifier-hz", 50e3, "-o", tmp_path / "record.csv")
    out = measured(built, tmp_path / "record.csv")
    assert out["of"] == "the controller and the stage"
    assert out["found"][0].startswith("Rd3 is 8 % above its value") and out["tied"] == []
    corner = out["found"][1].split()
    assert corner[:3] == ["amplifier:", "corner", "is"] and corner[4] == "kHz" and float(corner[3]) == pytest.approx(50.0, rel=0.02)
    # The noise of the bench is 2e-5 of the stroke.
    assert out["gap_percent"]["before"] > 10 * out["gap_percent"]["with_what_was_found"]
    assert out["gap_percent"]["with_what_was_found"] == pytest.approx(0.002, rel=0.15)
    tracking = out["next"]["tracking_percent"]
    assert tracking["predicted"] < 0.5 * tracking["before"]
    assert "corner_hz = 100000" not in (built / "next/stage.toml").read_text()
    rows = list(csv.DictReader((built / "measured/comparison.csv").open()))
    assert len(rows) == 901 and set(rows[0]) == {"time_s", "u", "measured", "predicted", "with_what_was_found"}


def test_a_controller_as_it_was_meant_is_not_accused(built, tmp_path):
    bench("controller", built, "-o", tmp_path / "record.csv")
    out = measured(built, tmp_path / "record.csv")
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
    bench("controller", built, *(f"{part}={factor}" for part, factor in off.items()), "-o", tmp_path / "wrong.csv")
    out = measured(built, tmp_path / "wrong.csv")
    assert len(out["found"]) == 1 and out["found"][0].startswith("Rd3 is 8")


def test_a_capacitor_of_the_circuit(built, tmp_path):
    bench("circuit", built, "C1_2=1.08", "-o", tmp_path / "bode.csv")
    out = measured(built, tmp_path / "bode.csv")
    assert out["of"] == "the circuit" and out["found"][0].startswith("C1_2 is 7.3")
    assert out["next"]["response_percent"]["before"] > 10 * out["next"]["response_percent"]["predicted"]
    bench("circuit", built, "-o", tmp_path / "good.csv")
    assert measured(built, tmp_path / "good.csv")["found"] == []


def test_resistors_of_which_only_the_ratio_shows_are_a_tie_that_one_part_mends(built, tmp_path):
    bench("circuit", built, "R2_1=1.1", "-o", tmp_path / "bode.csv")
    out = measured(built, tmp_path / "bode.csv")
    assert "R2_1" in out["tied"] and "R1_1" in out["tied"]
    assert out["next"]["response_percent"]["before"] > 5 * out["next"]["response_percent"]["predicted"]
    assert "Rx_" in (built / "next/compensator.sub").read_text()


def test_bad_input_is_one_line_and_nothing_is_written(built, tmp_path):
    before = sorted(built.rglob("*"))
    (tmp_path / "bad.csv").write_text("frequency_hz,magnitude_db\n1,x\n")
    other = tmp_path / "other.toml"
    other.write_text(PROJECT.read_text().replace("../", str(ROOT / "examples") + "/").replace("[1, 100]", "[1, 50]"))
    (tmp_path / "bode.csv").write_text("frequency_hz,magnitude_db\n1,0\n2,0\n3,0\n")
    for arguments in ((PROJECT, "--measured", tmp_path / "bad.csv"), (PROJECT, "--measured", tmp_path / "none.csv"), (other, "--measured", tmp_path / "bode.csv")):
        done = run("run", *arguments, "-o", built)
        assert done.status == 2 and len(done.err.splitlines()) == 1, done.err
    assert sorted(built.rglob("*")) == before
