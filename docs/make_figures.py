#!/usr/bin/env python3
"""Makes README's plot and the two tables of docs/figures.md, accuracy and speed, from what the built program measures, in one run.

Usage: docs/make_figures.py [path of bodesmith]     (default build/bin/bodesmith; run ./run first)

The speed programs of bench/ take part where they are built (cmake --preset bench && cmake --build --preset bench), scipy where a
python3 has it: /usr/bin/python3, or what BODESMITH_PEERS_PYTHON names.
"""
import json
import math
import os
import pathlib
import platform
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/bin/bodesmith")
EXAMPLE = ROOT / "examples/nanopositioner"


def bodesmith(*arguments):
    """Runs the program with --json; its summary and the wall time of the whole process."""
    start = time.monotonic()
    done = subprocess.run([PROGRAM, *map(str, arguments), "--json"], capture_output=True, text=True, cwd=ROOT)
    if done.returncode not in (0, 1):
        sys.exit(f"{arguments}: {done.stderr}")
    return json.loads(done.stdout), time.monotonic() - start


def number(value, digits=3):
    return f"{value:.{digits}g}"


def write_inputs(out):
    """A low-pass of eight poles, eight sections in series, a million samples, smooth and noisy curves, sixteen sections."""
    bodesmith("design", "lowpass", "--family", "butterworth", "--order", 8, "--corner-hz", 1000, "-o", out / "lowpass.json")
    bodesmith("design", "lowpass", "--family", "bessel", "--order", 16, "--corner-hz", 1000, "-o", out / "sixteen.json")
    block = '[[block]]\ntype = "pole_zero"\ngain = 1.0\nzero_hz = {}\npole_hz = {}\n'
    model = "".join(block.format(39 * 2**i, 30 * 2**i) for i in range(8))
    (out / "model.toml").write_text('schema = "bodesmith.model/1"\n' + model)
    chance = random.Random(1)
    with open(out / "u.csv", "w") as file:
        file.write("time_s,u\n")
        file.writelines(f"{i * 1e-5:.5f},{chance.random():.6f}\n" for i in range(1000000))
    for name, noise in (("smooth", 0.0), ("noisy", 0.1)):
        with open(out / f"{name}.csv", "w") as file:
            file.write("frequency_hz,magnitude_db\n")
            for i in range(400):
                f = 20 * 1000 ** (i / 399)
                db = -10 * math.log10(f) + 1.5 * math.exp(-((math.log(f / 500) / 0.4) ** 2)) + chance.gauss(0, noise)
                file.write(f"{f:.9g},{db:.9g}\n")


def least_compute(count, *arguments):
    """Smallest timing_s.compute and smallest time of the whole process, of `count` runs; the last summary."""
    computed, whole = [], []
    for _ in range(count):
        summary, wall = bodesmith(*arguments)
        computed.append(summary["timing_s"]["compute"])
        whole.append(wall)
    return min(computed), min(whole), summary


def milliseconds(seconds):
    return number(1e3 * seconds) + " ms"


def scipy_peers(curve):
    """Seconds of the same work by scipy; empty without it."""
    python = os.environ.get("BODESMITH_PEERS_PYTHON", "/usr/bin/python3")
    done = subprocess.run([python, ROOT / "bench/peers/scipy_speed.py", curve], capture_output=True, text=True)
    return json.loads(done.stdout) if done.returncode == 0 else {}


def measured_benchmarks():
    """Time in ms of every google-benchmark program that is built, as "program/benchmark"."""
    out = {}
    for program in ("simulate_speed", "simulate_frequency", "simulate_records"):
        path = ROOT / "build-bench/bin" / f"bench_{program}"
        if not path.exists():
            continue
        done = subprocess.run([path, "--benchmark_format=json"], capture_output=True, text=True, check=True)
        scale = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}
        for one in json.loads(done.stdout)["benchmarks"]:
            if "error_occurred" not in one:
                out[f"{program}/{one['name']}"] = one["real_time"] * scale[one["time_unit"]]
    return out


def speed_table(out):
    """What takes how long, and the same work by a peer in the same run."""
    write_inputs(out)
    peers = scipy_peers(out / "noisy.csv")
    by_scipy = f"scipy {peers.get('version', '')}"
    rows = []

    def add(what, time_text, peer="", peer_time=""):
        both = [re.match(r"[-+.0-9e]+(?= ms)", text) for text in (time_text, peer_time)]
        if all(both) and float(both[1][0]) < float(both[0][0]):
            peer_time += ", faster"
        rows.append((what, time_text, peer, peer_time))

    def peer_s(key):
        return milliseconds(peers[key]) if peers else "not installed"

    s, _, _ = least_compute(10, "bode", out / "lowpass.json", "--from-hz", 1, "--to-hz", 100000, "--count", 100000, "-o", out / "b.csv")
    add("dB and phase of 8 poles at 100 000 frequencies", milliseconds(s), by_scipy + ", freqs_zpk", peer_s("bode_s"))
    s, whole, _ = least_compute(5, "simulate", out / "model.toml", "--input", out / "u.csv", "-o", out / "y.csv")
    add("8 sections, 1 000 000 samples", milliseconds(s), by_scipy + ", sosfilt", peer_s("sections_s"))
    add("the same, whole process with its tables read and written", milliseconds(whole))
    for curve in ("smooth", "noisy"):
        for order in range(4, 9):
            s, _, got = least_compute(3, "fit", out / f"{curve}.csv", "--direct", "--order", order, "-o", out / "s.json")
            text = f"{milliseconds(s)}, {number(got['max_db'])} dB"
            if curve == "noisy" and order == 8:
                peer = f"{peer_s('fit_s')}, {number(peers['fit_db'])} dB" if peers else peer_s("fit_s")
                add(f"direct fit of a {curve} curve of 400 points, order {order}", text, by_scipy + ", least_squares, real roots, one start", peer)
            else:
                add(f"direct fit of a {curve} curve of 400 points, order {order}", text)
    s, _, _ = least_compute(3, "fpaa", out / "sixteen.json", "-o", out / "fpaa")
    add("FPAA plan of 16 poles", milliseconds(s))
    bench = measured_benchmarks()
    pairs = (("eight poles behind a switched cubic, 1 s, exact", "simulate_speed/engine/exact_from_a_million_samples",
              "ngspice, whole process", "simulate_speed/ngspice_ideal/iterations:1"),
             ("the same by CVODE at 1e-6", "simulate_speed/engine/cvode_1e6", "ngspice, whole process", "simulate_speed/ngspice_ideal/iterations:1"),
             ("responses at many frequencies", "simulate_frequency/responses", "std::complex, one by one", "simulate_frequency/peer_complex"),
             ("sections sample by sample", "simulate_records/by_modes", "dense matrix", "simulate_records/peer_matrix"),
             ("writing a table", "simulate_records/write_table", "printf", "simulate_records/peer_printf"),
             ("reading a table", "simulate_records/read_table", "strtod", "simulate_records/peer_strtod"))
    for what, key, peer, peer_key in pairs:
        if key in bench:
            add(what, number(bench[key]) + " ms", peer, number(bench[peer_key]) + " ms" if peer_key in bench else "not installed")
    table = "\n| work | bodesmith | peer | its time |\n|---|---|---|---|\n"
    return table + "".join(f"| {' | '.join(row)} |\n" for row in rows)


def main():
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        walls = []
        for _ in range(5):
            run, wall = bodesmith("run", "examples/nanopositioner/project.toml", "-o", out / "run")
            walls.append(wall)
        tracked = run["tracking"]
        # What the paper builds: the cascade and its sections.
        run, _ = bodesmith("run", "examples/nanopositioner/seed.toml", "-o", out / "seed")
        shutil.copy(out / "seed/bode.svg", ROOT / "docs/nanopositioner.svg")
        got = {limit["name"]: limit["got"] for limit in run["limits"]}
        rows.append(("main example, whole process (median of 5)", f"{statistics.median(walls):.2f} s"))
        rows.append(("  of it fit to plan, netlist and layout", f"{run['timing_s']['design']:.2f} s"))
        rows.append(("largest error of the cascade at the points", number(got["fit_db"], 2) + " dB"))
        rows.append(("sections against the cascade, every frequency", number(got["approximation_db"]) + " dB"))
        rows.append(("the paper's cascade on the FPAA, worst complex error as it runs", number(got["fpaa_percent"]) + " %"))
        rows.append(("E96/E12 circuit against the sections", number(got["circuit_db"]) + " dB"))
        if run["ngspice"]:
            rows.append(("ngspice on the emitted netlist against the sections, to 10 x the top corner",
                         number(run["ngspice"]["against_sections_db"]) + " dB"))
            rows.append(("ngspice against the program's own network solution",
                         number(run["ngspice"]["against_network_db"], 2) + " dB"))
        rows.append(("worst tracking error as built, pure delay removed",
                     number(tracked["as_built_worst_percent_without_lag"], 2) + " % of range"))
        rows.append(("CVODE against the harmonic computation, tracking",
                     number(tracked["cross_check_percent"], 2) + " % of range"))
        speed = speed_table(out)
    table = "| figure | measured |\n|---|---|\n"
    table += "".join(f"| {name.strip()} | {value} |\n" for name, value in rows)
    table += speed
    table += f"\nMeasured with docs/make_figures.py on {platform.machine()}, two cores; peers in the same run.\n"
    page = ROOT / "docs/figures.md"
    text = page.read_text()
    text = re.sub(r"(<!-- figures -->\n).*?(<!-- end of figures -->)", lambda m: m[1] + table + m[2], text, flags=re.S)
    page.write_text(text)


main()
