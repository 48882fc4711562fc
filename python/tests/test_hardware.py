"""fpaa, spice, layout, yield: against the command line's files."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest

import bodesmith as bs
from conftest import assert_same


def test_plan_is_the_command_lines(plan, board, tmp_path):
    written = json.loads((board / "plan.json").read_text())
    for chip in written["chips"]:
        del chip["pins"]  # those of its streams
    assert_same(plan.to_dict(), written)
    plan.write(tmp_path / "mine")
    assert (tmp_path / "mine/build_sheet.md").read_text() == (board / "build_sheet.md").read_text()
    assert bs.Plan.load(tmp_path / "mine/plan.json").error == plan.error


def test_plan_responds_as_it_says(plan, sections):
    low, high = plan.error_with_delays["band_hz"]
    f = np.geomspace(low, high, 100)
    percent = 100 * np.max(np.abs(plan.response(f) / sections.response(f) - 1))
    assert percent == pytest.approx(plan.error_with_delays["max_complex_percent"], rel=0.05)
    without = 100 * np.max(np.abs(plan.response_without_delays(f) / sections.response(f) - 1))
    assert without <= plan.error["max_complex_percent"] * 1.01


def test_circuit_is_the_command_lines(sections, program, tmp_path):
    sections.save(tmp_path / "sections.json")
    program("spice", "sections.json", "--from-hz", 0.1, "--to-hz", 1000, "-o", "spice")
    circuit = bs.spice(sections, band_hz=(0.1, 1000.0))
    assert_same(circuit.to_dict(), json.loads((tmp_path / "spice/circuit.json").read_text()))
    written = {str(p.relative_to(tmp_path / "spice")) for p in (tmp_path / "spice").rglob("*") if p.is_file()}
    assert set(circuit.files) <= written
    assert circuit.files["parts.csv"] == (tmp_path / "spice/parts.csv").read_text()


@pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")
def test_netlist_in_ngspice(sections):
    circuit = bs.spice(sections)
    f = np.geomspace(1, 100, 20)
    difference = 20 * np.log10(np.abs(circuit.response(f) / sections.response(f)))
    assert np.max(np.abs(difference)) <= circuit.error["all"]["max_magnitude_db"] * 1.01


def test_layout_is_the_command_lines(disturbance, example, program, tmp_path):
    program("layout", example / "disturbance.json", "-o", "layout")
    layout = bs.layout(disturbance)
    assert_same(layout.to_dict(), json.loads((tmp_path / "layout/layout.json").read_text()))
    assert layout.files["parts.csv"] == (tmp_path / "layout/parts.csv").read_text()
    assert ".subckt disturbance x branch out" in layout.netlist


def test_yield_is_the_command_lines(sections, plan, program, tmp_path):
    sections.save(tmp_path / "sections.json")
    program("yield", "sections.json", "--samples", 500, "--limit-db", 0.5, "--seed", 7, "--from-hz", 1, "--to-hz", 100, "-o", "yield.json")
    statistics = bs.yield_(sections, names=["sections.json"], samples=500, limit_db=0.5, seed=7, band_hz=(1.0, 100.0))
    written = json.loads((tmp_path / "yield.json").read_text())
    assert_same(statistics.designs[0], written["designs"][0])
    assert bs.yield_(plan, samples=50).designs[0]["reference"] == "nominal"


def test_yield_of_a_circuit_as_it_was_built(sections, program, tmp_path):
    circuit = bs.spice(sections)
    assert circuit.to_dict()["judged"]["max_magnitude_db"] == circuit.error["all"]["max_magnitude_db"]
    circuit.save(tmp_path / "circuit.json")
    program("yield", "circuit.json", "--samples", 200, "-o", "yield.json")
    statistics = bs.yield_(circuit, names=["circuit.json"], samples=200)
    assert_same(statistics.designs[0]["worst_db"], json.loads((tmp_path / "yield.json").read_text())["designs"][0]["worst_db"])
    assert "dB with parts and op-amps" in repr(circuit)
    assert "in 95 of 100" in repr(statistics)


def test_yield_draws_what_the_design_states(sections, plan, tmp_path):
    circuit = bs.spice(sections).to_dict() | {"tolerances": {"resistor_percent": 0.5, "capacitor_percent": 2.0}}
    (tmp_path / "circuit.json").write_text(json.dumps(circuit))
    stated = bs.yield_(bs.Circuit.load(tmp_path / "circuit.json"), samples=50).to_dict()
    assert (stated["resistor_percent"], stated["capacitor_percent"]) == (0.5, 2.0)
    assert bs.yield_(plan, samples=50).to_dict()["unit_capacitor_percent"] == plan.to_dict()["mismatch"]["unit_capacitor_percent"]
    assert bs.yield_(plan, samples=50, unit_capacitor_percent=1.5).to_dict()["unit_capacitor_percent"] == 1.5


def test_delay_is_left_out_and_said():
    with pytest.warns(bs.BodesmithWarning, match="delay"):
        circuit = bs.spice(bs.Sections([(10.0, [], [-10.0])], delay_s=1e-3))
    assert circuit.warnings
