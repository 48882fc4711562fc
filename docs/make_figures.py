#!/usr/bin/env python3
"""Makes README's plot and its table of figures from what the built program measures, in one run.

Usage: docs/make_figures.py [path of bodesmith]     (default build/bin/bodesmith; run ./run first)
"""
import json
import pathlib
import platform
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
        rows.append(("the paper's cascade on the FPAA at one clock of 2 kHz, worst complex error as it runs", number(got["fpaa_percent"]) + " %"))
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
    table = "| figure | measured |\n|---|---|\n"
    table += "".join(f"| {name.strip()} | {value} |\n" for name, value in rows)
    table += f"\nMeasured with docs/make_figures.py on {platform.machine()}, two cores.\n"
    readme = ROOT / "README.md"
    text = readme.read_text()
    text = re.sub(r"(<!-- figures -->\n).*?(<!-- end of figures -->)", lambda m: m[1] + table + m[2], text, flags=re.S)
    readme.write_text(text)


main()
