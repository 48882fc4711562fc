"""Files that other programs wrote themselves, where they are at hand (../shared/data/formats, whose README names their source)."""

import cmath
import csv
import math

import pytest
from conftest import ROOT, run

FOLDER = ROOT.parent / "shared/data/formats"
# An inductor of LTspice has 1 mOhm in series unless it is told otherwise.
L, R, SERIES = 1.2e-3, 2.0, 1e-3


def table(file, choice, folder):
    source = FOLDER / file
    if not source.is_file():
        pytest.skip(f"{source} is not there")
    made = run("export", f"{source}:{choice}", "-o", folder / "own.csv")
    assert made.status == 0 and "LTspice raw file" in made.out, made.out + made.err
    return [list(map(float, row)) for row in csv.reader((folder / "own.csv").read_text().splitlines()) if row[0][0].isdigit()]


@pytest.mark.parametrize("file", ["ltspice_rl_circuit_ac.raw", "ltspice_rl_circuit_acascii.raw"])
def test_ltspice_ac(file, tmp_path):
    rows = table(file, "V(r1)/V(n001)", tmp_path)
    assert len(rows) == 1330 and rows[0][0] == 1.0 and rows[-1][0] == pytest.approx(1e4)
    for f, db, deg in rows:
        h = R / (R + SERIES + 2j * math.pi * f * L)
        assert abs(db - 20.0 * math.log10(abs(h))) < 1e-6 and abs(deg - math.degrees(cmath.phase(h))) < 1e-6, f


@pytest.mark.parametrize("file, accuracy", [("ltspice_rl_circuit_tran.raw", 2e-5), ("ltspice_rl_circuit_tran64b.raw", 2e-5)])
def test_ltspice_transient(file, accuracy, tmp_path):
    rows = table(file, "V(n001),V(r1)", tmp_path)
    step = rows[1][0]
    assert all(abs(row[0] - i * step) < 1e-9 for i, row in enumerate(rows))
    # Of the differential equation L di/dt = u - R i over one second, by trapezia: LTspice's own rule, on its own samples.
    error = 0.0
    for (_, u0, y0), (_, u1, y1) in zip(rows, rows[1:]):
        error = max(error, abs((y1 - y0) * L / R / step - 0.5 * (u0 + u1 - y0 - y1)))
    assert error < 0.05 * 10.0
    single = table("ltspice_rl_circuit_tran.raw", "V(n001),V(r1)", tmp_path)
    double = table("ltspice_rl_circuit_tran64b.raw", "V(n001),V(r1)", tmp_path)
    assert max(abs(a[2] - b[2]) for a, b in zip(single, double)) < accuracy
