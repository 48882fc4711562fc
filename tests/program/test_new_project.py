"""`new` writes projects that run as they are, from flags or from answers, and overwrites nothing."""

import json
import re
import shlex

import pytest
from conftest import ROOT, run
from test_terminal import Terminal


@pytest.mark.parametrize("kind", ["filter", "fractional-pid", "nanopositioner", "diagnosis"])
def test_every_kind_runs_as_it_is(kind, tmp_path):
    made = run("new", "mine", "--kind", kind, "--json", cwd=tmp_path)
    assert made.status == 0, made.err
    summary = json.loads(made.out)
    folder = tmp_path / "mine"
    assert sorted(summary["files"]) == sorted(str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file())
    command = shlex.split(summary["command"])
    assert command[0] == "bodesmith" and " ".join(command) in (folder / "README.md").read_text()
    # What it simulates and what parts that are off make of it: test_tracking_limits, MainExample.
    less = [] if kind == "diagnosis" else ["--max-seconds", 1e-6]
    done = run(*command[1:], *less, cwd=folder, env={"BODESMITH_NGSPICE": "/nowhere"})
    assert done.status == 0, done.out + done.err
    assert (folder / "out/report.html").stat().st_size > 10_000
    if kind == "nanopositioner":  # no time at all: the design stands, and what was left out is said
        assert "not tried in the time given: errors of the controller's parts" in done.out
        assert len(json.loads((folder / "out/run.json").read_text())["not_tried"]) >= 3
        assert all((folder / "out" / name).is_file() for name in ("sections.json", "controller/controller.sub", "tracking.csv"))
    if kind == "diagnosis":
        diagnosis = json.loads((folder / "out/diagnosis.json").read_text())
        assert diagnosis["verdict"] == "explained" and diagnosis["steps"][0]["effect"] == "amplifier_pole"
    else:
        missed = [limit for limit in json.loads((folder / "out/run.json").read_text())["limits"] if not limit["met"]]
        assert missed == []


def test_every_toml_file_says_what_its_lines_are_and_names_its_schema(tmp_path):
    for kind in ("filter", "fractional-pid", "nanopositioner", "diagnosis"):
        run("new", tmp_path / kind, "--kind", kind)
        for file in (tmp_path / kind).glob("*.toml"):
            text = file.read_text()
            named = re.match(r"#:schema (\S+)\n", text)
            assert named and (file.parent / named[1]).is_file(), file
            assert text.count("#") > 3, file


def test_flags_are_what_the_files_hold(tmp_path):
    points = tmp_path / "p.csv"
    points.write_text("frequency_kHz,gain\n0.1,1\n1,1.5\n10,1\n")
    made = run("new", tmp_path / "f", "--kind", "filter", "--points", points, "--max-error-db", "0.5", "--hardware", "fpaa", "--name", "Presence")
    assert made.status == 0, made.err
    text = (tmp_path / "f/project.toml").read_text()
    assert 'name = "Presence"' in text and "max_error_db = 0.5" in text
    assert "[hardware.fpaa]" in text and "[hardware.circuit]" not in text
    assert (tmp_path / "f/points.csv").read_text() == points.read_text()
    run("new", tmp_path / "g", "--kind", "fractional-pid", "--kp", "2", "--to-hz", "2k")
    assert "kp = 2.0" in (tmp_path / "g/pid.toml").read_text()
    assert "to_hz = 2000.0" in (tmp_path / "g/project.toml").read_text()


def test_nothing_is_overwritten_and_nothing_half_made(tmp_path):
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "project.toml").write_text("mine\n")
    said = run("new", folder, "--kind", "filter")
    assert said.status == 2 and "nothing is overwritten" in said.err
    assert [file.name for file in folder.iterdir()] == ["project.toml"] and (folder / "project.toml").read_text() == "mine\n"
    bad = tmp_path / "bad.csv"
    bad.write_text("frequency_hz,gain\n1,x\n")
    said = run("new", tmp_path / "other", "--kind", "filter", "--points", bad)
    assert said.status == 2 and "bad.csv:2" in said.err and not (tmp_path / "other").exists()
    assert run("new", tmp_path / "third").status == 2  # no kind, and nobody to ask


def test_questions_at_a_terminal(tmp_path):
    seen = Terminal("new", "mine", cwd=tmp_path)
    seen.wait_for(r"Which of these \[.*\]: ")
    seen.send("filter\n")
    seen.wait_for(r"Largest error at a point, in dB \[0\.3\]: ")
    seen.send("0.4\n")
    seen.wait_for(r"circuit.*\]: ")
    seen.send("\n")
    text = seen.finish()
    assert seen.status == 0, text
    project = (tmp_path / "mine/project.toml").read_text()
    assert "max_error_db = 0.4" in project and "[hardware.circuit]" in project and "[hardware.fpaa]" not in project
