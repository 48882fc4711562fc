"""Scripts for python-control and Octave rebuild plan, model and sections, and notice when they do not."""

import cmath
import csv
import importlib.util
import json
import math
import shutil
import subprocess
import sys

import pytest
from conftest import ROOT, run

MODEL = """schema = "bodesmith.model/1"
[[block]]
type = "gain"
gain = 6.92
[[block]]
type = "lowpass"
corner_hz = 250.0
[[block]]
type = "resonator"
gain = 1.5
natural_frequency_hz = 820.0
damping_ratio = 0.02
[[block]]
type = "pole_zero"
gain = 1.0
zero_hz = 40.0
pole_hz = 55.0
[[block]]
type = "creep"
gains = [0.05, 0.03]
time_constants_s = [0.2, 2.0]
[[block]]
type = "delay"
delay_s = 1e-4
"""


@pytest.fixture(scope="module")
def designs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("designs")
    (folder / "model.toml").write_text(MODEL)
    assert run("design", "lowpass", "--order", "4", "--corner-hz", "200", "-o", folder / "sections.json").status == 0
    # Several clocks.
    assert run("fit", ROOT / "examples/nanopositioner/gains.csv", "-o", folder / "cascade.json").status == 0
    assert run("approximate", folder / "cascade.json", "--order", "4", "-o", folder / "board.json").status == 0
    plan = run("fpaa", folder / "board.json", "-o", folder / "fpaa")
    assert plan.status == 0, plan.err
    assert len({cam["clock_a_hz"] for chip in json.loads((folder / "fpaa/plan.json").read_text())["chips"] for cam in chip["cams"]}) > 1
    (folder / "plan.json").write_bytes((folder / "fpaa/plan.json").read_bytes())
    return folder


def responses(folder, file):
    """What `bode` finds, by frequency."""
    assert run("bode", folder / file, "--from-hz", "1", "--to-hz", "140", "--count", "9", "-o", folder / "bode.csv").status == 0
    rows = list(csv.reader(line for line in (folder / "bode.csv").read_text().splitlines() if not line.startswith("#")))[1:]
    return [(float(f), 10 ** (float(db) / 20.0) * complex(*polar(float(deg)))) for f, db, deg in rows]


def polar(deg):
    return math.cos(math.radians(deg)), math.sin(math.radians(deg))


@pytest.mark.parametrize("file", ["model.toml", "plan.json", "sections.json"])
def test_python(designs, file):
    script = designs / (file.split(".")[0] + "_script.py")
    made = run("export", designs / file, "-o", script)
    assert made.status == 0, made.err
    spec = importlib.util.spec_from_file_location(script.stem, script)
    module = importlib.util.module_from_spec(spec)
    if file == "model.toml":
        pytest.importorskip("numpy", reason="numpy is not installed")
    spec.loader.exec_module(module)
    for f, h in responses(designs, file):
        assert abs(module.response(f) / h - 1.0) < (2e-4 if file == "plan.json" else 1e-9), f
    if file != "sections.json":
        done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60)
        assert done.returncode == 0 and "off by at most" in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("file", ["model.toml", "plan.json", "sections.json"])
def test_octave(designs, file):
    if shutil.which("octave-cli") is None:
        pytest.skip("Octave is not installed")
    script = designs / (file.split(".")[0] + "_script.m")
    assert run("export", designs / file, "-o", script).status == 0
    done = subprocess.run(["octave-cli", "--norc", str(script)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and "off by at most" in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("file", ["model.toml", "plan.json"])
def test_a_script_that_rebuilds_something_else_says_so(designs, file):
    pytest.importorskip("numpy", reason="numpy is not installed")
    script = designs / (file.split(".")[0] + "_wrong.py")
    assert run("export", designs / file, "-o", script).status == 0
    lines = script.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("BLOCKS = ["))
    head, tail = lines[first + 1].rsplit("], ", 1)
    wrong = head + "], 1.01 * " + tail
    script.write_text("\n".join(lines[: first + 1] + [wrong] + lines[first + 2 :]))
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1, done.stdout + done.stderr


def test_what_is_not_linear_is_refused(designs):
    said = run("export", ROOT / "examples/piezo_loop/stage.toml", "-o", designs / "no.py")
    assert said.status == 2 and "not linear" in said.err
    # What is rebuilt of a board is what it does as it runs.
    said = run("export", designs / "plan.json", "--without-holds", "-o", designs / "no.py")
    assert said.status == 2, said.out


def test_a_plans_exported_response_is_the_board_as_it_runs(designs):
    band = ["--from-hz", "1", "--to-hz", "140", "--count", "5"]
    for options, bode in ([], []), (["--without-holds"], ["--without-holds"]):
        assert run("export", designs / "plan.json", *options, *band, "-o", designs / "plan.frd").status == 0
        assert run("bode", designs / "plan.json", *bode, *band, "-o", designs / "plan.csv").status == 0
        rows = [list(map(float, line.split())) for line in (designs / "plan.frd").read_text().splitlines() if line[:1].isdigit()]
        wanted = [list(map(float, line.split(","))) for line in (designs / "plan.csv").read_text().splitlines() if line[:1].isdigit()]
        assert len(rows) == len(wanted) == 5
        for got, want in zip(rows, wanted):
            assert all(abs(a - b) < 1e-6 * max(1.0, abs(b)) for a, b in zip(got, want)), (got, want)


@pytest.mark.parametrize("columns", ["dB and degrees", "dB of the first trace alone"])
def test_the_bode_100_suite_of_2016(columns, tmp_path):
    # Its headings as a real file has them; parts of complex numbers stand where units stand elsewhere.
    rule = "-" * 69
    head = f"---Measurement Setup---{rule}\nDevice Type: Bode100\nDate: 07-12-2016\nSweep Mode: Logarithmic\n{rule}\n"
    two = columns == "dB and degrees"
    head += "Frequency (Hz),TR1: Gain (Real),TR1: Gain (Imag),TR1: Gain (dB)"
    head += ",TR2: Gain (Real),TR2: Gain (Imag),TR2: Gain (Degree)\n" if two else "\n"
    text = head
    wanted = []
    for i in range(17):
        f = 10.0 ** (1 + i / 4)
        h = 1.0 / (1.0 + 1j * f / 1000.0)
        db, deg = 20.0 * math.log10(abs(h)), math.degrees(cmath.phase(h))
        wanted.append((f, db, deg))
        text += f"{f!r},{h.real!r},{h.imag!r},{db!r}" + (f",{h.real!r},{h.imag!r},{deg!r}\n" if two else "\n")
    (tmp_path / "bode.csv").write_text(text)
    made = run("export", tmp_path / "bode.csv", "-o", tmp_path / "own.csv")
    assert made.status == 0 and "Bode 100 CSV" in made.out, made.out + made.err
    rows = [row for row in csv.reader((tmp_path / "own.csv").read_text().splitlines()) if row[0][0].isdigit()]
    assert len(rows) == 17
    for row, (f, db, deg) in zip(rows, wanted):
        for got, right in zip(map(float, row), (f, db, deg)):
            assert abs(got - right) < 1e-9 * max(1.0, abs(right))


# Pins of LTspice's own symbols, turned by 0 degrees: their places in the order of its netlist.
PINS = {
    "res": [(16, 16), (16, 96)],
    "cap": [(16, 0), (16, 64)],
    "voltage": [(0, 16), (0, 96)],
    "Opamps\\\\opamp": [(-32, 48), (-32, 80), (32, 64)],  # minus, plus, output
}


def nets_of_sheet(text):
    """{instance: (symbol, nets of its pins, attributes)} of an .asc, by following its wires to the names of nets."""
    above = {}

    def root(point):
        while above.setdefault(point, point) != point:
            point = above[point]
        return point

    flags, symbols = [], []
    for line in text.splitlines():
        words = line.split(" ", 3)
        if words[0] == "WIRE":
            x1, y1, x2, y2 = map(int, line.split()[1:])
            above[root((x1, y1))] = root((x2, y2))
        elif words[0] == "FLAG":
            flags.append(((int(words[1]), int(words[2])), words[3]))
        elif words[0] == "SYMBOL":
            name, x, y, turn = line.split(" ")[1:]
            assert turn == "R0"
            symbols.append((name, int(x), int(y), {}))
        elif words[0] == "SYMATTR":
            key, value = line.split(" ", 2)[1:]
            symbols[-1][3][key] = value
    names = {}
    for point, name in flags:
        assert names.setdefault(root(point), name) == name, "two names on one net"
    out = {}
    for name, x, y, attributes in symbols:
        nets = tuple(names[root((x + dx, y + dy))] for dx, dy in PINS[name])
        assert attributes["InstName"] not in out
        out[attributes["InstName"]] = (name, nets, attributes)
    return out


def test_ltspice_sheet(designs):
    assert run("spice", designs / "sections.json", "-o", designs / "spice").status in (0, 1)
    made = run("export", designs / "spice/circuit.json", "-o", designs / "circuit.asc")
    assert made.status == 0, made.err
    text = (designs / "circuit.asc").read_text()
    sheet = nets_of_sheet(text)
    # Every part between its two nets, with its value; the netlist of compensator.sub has the same ones.
    wanted = {}
    for stage in json.loads((designs / "spice/circuit.json").read_text())["stages"]:
        for part in stage["parts"]:
            wanted[part["part"]] = ({part["from"], part["to"]}, part.get("realised_ohm", part.get("realised_f")))
    found = {name: (set(nets), float(attributes["Value"])) for name, (symbol, nets, attributes) in sheet.items() if symbol in ("res", "cap")}
    assert found == wanted and len(wanted) > 4
    opamps = {name: nets for name, (symbol, nets, _) in sheet.items() if symbol.startswith("Opamps")}
    library = (designs / "spice/compensator.sub").read_text()
    calls = [line for line in library.splitlines() if line.startswith("X") and line.endswith(" bodesmith_opamp")]
    assert len(opamps) == len(calls) and len(set(opamps.values())) == len(opamps)
    assert {"in", "out"} <= {net for _, nets, _ in sheet.values() for net in nets}
    if shutil.which("ngspice") is None:
        pytest.skip("ngspice is not installed: the sheet's netlist was not run")
    deck = "sheet\n"
    for name, (symbol, nets, attributes) in sheet.items():
        if symbol in ("res", "cap"):
            deck += f"{name} {nets[0]} {nets[1]} {attributes['Value']}\n"
        elif symbol == "voltage":
            deck += f"{name} {nets[0]} {nets[1]} dc 0 ac 1\n"
        else:
            gain = float(attributes["SpiceLine"].split("=")[1])
            pole = float(attributes["SpiceLine2"].split("=")[1]) / gain
            deck += f"E{name} x{name} 0 {nets[1]} {nets[0]} {gain!r}\nR{name} x{name} {name}p 1\nC{name} {name}p 0 {1 / (2 * math.pi * pole)!r}\n"
            deck += f"EO{name} {nets[2]} 0 {name}p 0 1\n"
    (designs / "sheet.cir").write_text(deck + ".ac dec 10 30 10k\n.end\n")
    both = run("bode", designs / "sheet.cir", designs / "spice/compensator.sub", "--from-hz", "30", "--to-hz", "5000", "--count", "7", "-o", designs / "both.csv")
    assert both.status == 0, both.err
    rows = [row for row in csv.reader((designs / "both.csv").read_text().splitlines()) if row[0][0].isdigit()]
    for row in rows:
        assert abs(float(row[1]) - float(row[3])) < 0.01, row


def test_only_a_circuit_becomes_a_sheet(designs):
    said = run("export", designs / "sections.json", "-o", designs / "no.asc")
    assert said.status == 2 and "circuit.json" in said.err
