"""What a plan states against engines that share nothing with it: the bytes of its streams read by chip_bytes.py, and its
board.sub in ngspice, over the whole waveform."""

import json
import math
import shutil
import subprocess

import numpy as np
import pytest
from chip_bytes import board_of, sections_response
from conftest import ROOT, run

EXAMPLES = ROOT / "examples"


def design(*words):
    return [("design", *words, "-o", "sections.json")]


# Every kind of plan: the vendor's CAMs and this program's own stages, one clock and several, and the examples.
PLANS = {
    "the paper's": (
        [
            ("fit", EXAMPLES / "nanopositioner/gains.csv", "-o", "cascade.json"),
            ("approximate", "cascade.json", "--order", 3, "-o", "sections.json"),
        ],
        (),
    ),
    "low pass": (design("lowpass", "--family", "butterworth", "--order", 2, "--corner-hz", 1000), (20, 3000)),
    "high pass": (design("highpass", "--family", "butterworth", "--order", 3, "--corner-hz", 500), (50, 2000)),
    "band pass": (design("bandpass", "--family", "butterworth", "--order", 2, "--from-hz", 700, "--to-hz", 1400), (20, 3000)),
    "notch": (
        design("lowpass", "--family", "elliptic", "--order", 3, "--corner-hz", 800, "--ripple-db", 0.5, "--stop-db", 40),
        (20, 2000),
    ),
    "riaa": ([("fit", EXAMPLES / "riaa/points.csv", "--direct", "--max-error-db", 0.001, "-o", "sections.json")], (20, 20000)),
    "pink noise": ([("fit", EXAMPLES / "pink_noise/points.csv", "--direct", "--order", 6, "-o", "sections.json")], ()),
}


class Made:
    def __init__(self, name, folder):
        steps, band = PLANS[name]
        for step in steps:
            assert run(*step, cwd=folder).status in (0, 1)
        limits = ("--from-hz", band[0], "--to-hz", band[1]) if band else ()
        done = run("fpaa", "sections.json", "-o", "board", "--stream", "--spice", *limits, cwd=folder)
        assert done.status == 0, done.err
        self.folder = folder
        self.plan = json.loads((folder / "board/plan.json").read_text())
        self.sections = json.loads((folder / "sections.json").read_text())
        self.clocks = sorted({cam["clock_a_hz"] for chip in self.plan["chips"] for cam in chip["cams"]})
        self.bytes = board_of(self.plan, folder / "board/stream")

    def percent(self, gain, hz):
        wanted, size = sections_response(self.sections, hz)
        return 100 * np.abs(gain - wanted) / size


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    known = {}

    def get(name):
        if name not in known:
            known[name] = Made(name, tmp_path_factory.mktemp("plan"))
        return known[name]

    return get


@pytest.mark.parametrize("name", PLANS)
def test_bytes_make_the_error_that_the_plan_states(made, name):
    it = made(name)
    stated = it.plan["error_with_delays"]
    hz = np.append(np.geomspace(*stated["band_hz"], 60), stated["worst_hz"])
    got = it.percent(it.bytes.gain(hz), hz)
    assert abs(got[-1] - stated["max_complex_percent"]) < 1e-4
    assert got.max() < 1.02 * stated["max_complex_percent"] + 0.02


def components(seconds, volts, begin, window, hz):
    """Of the waveform, straight between ngspice's points, over a window of whole turns."""
    t = np.unique(np.concatenate(([begin, begin + window], seconds[(seconds > begin) & (seconds < begin + window)])))
    v = np.interp(t, seconds, volts)
    turned = [v * np.exp(-2j * np.pi * f * t) for f in hz]
    return np.array([np.sum(0.5 * (x[1:] + x[:-1]) * np.diff(t)) for x in turned]) * 2 / window


# Those that ngspice brings into their steady state within seconds, and the time constants of the slowest pole that takes
# (few where it stands beside a zero).
SETTLED = {"the paper's": 2, "low pass": 15, "high pass": 12, "band pass": 15, "notch": 12}


@pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")
@pytest.mark.parametrize("name", SETTLED)
def test_ngspice_makes_the_error_that_the_plan_states(made, name):
    it = made(name)
    slowest, fastest = it.clocks[0], it.clocks[-1]
    low, high = it.plan["error_with_delays"]["band_hz"]
    # Whole turns in a window of whole periods of every clock, none the image of another.
    periods = max(30, math.ceil(1.2 * slowest / high))
    window = periods / slowest
    turns = sorted({m for m in (1, 2, periods // 6, math.floor(high * window)) if low <= m / window <= high and m < periods / 2})
    hz = np.array(turns) / window
    decay = min(-pole[0] for section in it.sections["sections"] for pole in section["poles_rad_s"])
    settled = math.ceil(SETTLED[name] / decay * slowest) / slowest
    nodes = ["in", *(f"t{k}" for k in range(1, len(hz))), "0"]
    tones = "\n".join(f"V{k} {nodes[k]} {nodes[k + 1]} SIN(0 0.1 {f:.15g})" for k, f in enumerate(hz))
    # ... and of switches that settle, as the op-amps do: 1 kohm lets 12 pF follow its input 24 ns late.
    board = it.folder / "board/board.sub"
    board.write_text(board.read_text().replace("*0.001}", "*0.1}"))
    step = 1 / (8 * fastest)
    (it.folder / "truth.cir").write_text(
        f"truth\n.include board/board.sub\n{tones}\nXb in out board\nRload out 0 1e9\n"
        # charge is kept whatever the steps inside an edge are
        ".options method=gear maxord=1 trtol=10000 reltol=1e-4 abstol=1e-14 vntol=1e-8 chgtol=1e-15 gmin=1e-13\n.control\n"
        f"tran {step:.9g} {settled + window:.15g} {settled:.15g} {step:.9g}\n"
        "set wr_singlescale\nset numdgt=14\nwrdata truth.txt v(out)\nquit 0\n.endc\n.end\n"
    )
    subprocess.run(["ngspice", "-b", "truth.cir"], cwd=it.folder, capture_output=True, timeout=500)
    table = np.loadtxt(it.folder / "truth.txt")
    got = components(table[:, 0], table[:, 1], settled, window, hz) / (-0.1j)
    stated = it.percent(it.bytes.gain(hz), hz)  # as the plan has it at its worst: above
    for f, one, other in zip(hz, it.percent(got, hz), stated):
        assert abs(one - other) < max(0.02, 0.02 * other), f"{f:.1f} Hz: ngspice {one:.4f} %, stated {other:.4f} %"


def test_run_and_streams_make_the_same_plan(tmp_path):
    """A plan does not depend on whether bytes are asked for, nor on whether `run` asks for it."""
    done = run("run", EXAMPLES / "audio_curve/project.toml", "-o", "out", cwd=tmp_path)
    assert done.status in (0, 1), done.err
    low, high = json.loads((tmp_path / "out/fpaa/plan.json").read_text())["error_with_delays"]["band_hz"]
    band = ("--from-hz", repr(low), "--to-hz", repr(high))
    plans = [json.loads((tmp_path / "out/fpaa/plan.json").read_text())]
    for name, more in (("without", ()), ("with", ("--stream",))):
        assert run("fpaa", "out/sections.json", "-o", name, *band, *more, cwd=tmp_path).status in (0, 1)
        plans.append(json.loads((tmp_path / name / "plan.json").read_text()))
    for plan in plans:
        for chip in plan["chips"]:
            chip.pop("pins", None)
    assert plans[0]["chips"] == plans[1]["chips"] == plans[2]["chips"]
    assert plans[0]["total"] == plans[1]["total"] == plans[2]["total"]


def cubic(a, x):
    return x * (a[0] + x * (a[1] + x * a[2]))


@pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed")
def test_ngspice_drives_the_stage_as_the_controller_on_the_board_is_told_to(tmp_path):
    """`fpaa controller`: the error that it states, by ngspice on its netlist and a stage that is worked out here."""
    hz, clock, gain = 800, 250e3, 1.12
    made = {"schema": "bodesmith.disturbance/1", "ascending": [0.31, -0.52, 0.21], "descending": [-0.2, 0.05, 0.15],
            "rate": {"frequency_hz": [1, 500], "ascending": [1, 1], "descending": [gain, gain]}}  # fmt: skip
    (tmp_path / "d.json").write_text(json.dumps(made))
    done = run("fpaa", "controller", "d.json", "--polynomial", "outside", "--structure", "loop", "--track-hz", hz,
               "--fast-clock-hz", clock, "-o", "out", cwd=tmp_path)  # fmt: skip
    assert done.status == 0, done.err
    half = 0.5 / hz
    start = math.ceil(0.2e-3 * clock) / clock  # the loop settles: falling, then one period from an edge of the clock on
    (tmp_path / "truth.cir").write_text(
        f"truth\n.include out/board_controller.sub\nVr r 0 PWL(0 {start / half:.12g} {start:.12g} 0"
        f" {start + half:.12g} 1 {start + 2 * half:.12g} 0)\nVu up 0 PWL(0 0 {start - 1e-9:.12g} 0 {start:.12g} 1"
        f" {start + half - 1e-9:.12g} 1 {start + half:.12g} 0)\nXc r up v controller\nRload v 0 1e9\n"
        ".options method=gear maxord=1 trtol=10000 reltol=1e-4 abstol=1e-14 vntol=1e-8 chgtol=1e-15 gmin=1e-13\n.control\n"
        f"tran {1 / clock:.9g} {start + 2 * half:.15g} 0 {0.5 / clock:.9g}\n"
        "set wr_singlescale\nset numdgt=14\nwrdata truth.txt v(v)\nquit 0\n.endc\n.end\n"
    )
    subprocess.run(["ngspice", "-b", "truth.cir"], cwd=tmp_path, capture_output=True, timeout=100)
    table = np.loadtxt(tmp_path / "truth.txt")
    count = 8192
    phase = (np.arange(count) + 0.5) / count
    v = np.interp(start + 2 * half * phase, table[:, 0], table[:, 1])
    up = phase < phase[np.argmax(v)]
    y = v + np.where(up, cubic(made["ascending"], v), gain * cubic(made["descending"], v))
    errors = [
        100 * np.sqrt(np.mean((y - np.interp((phase - late) % 1, [0, 0.5, 1], [0, 1, 0])) ** 2))
        for late in np.linspace(0, 0.02, 401)
    ]
    stated = np.genfromtxt(tmp_path / "out/tracking.csv", delimiter=",", names=True)
    assert abs(min(errors) - stated["controller_fpaa_outside_loop_percent"]) < 0.01, (min(errors), stated)
