#!/usr/bin/env python3
"""Makes docs/tracking_table.md: Table II of "Modeling and Control of Piezoelectric Hysteresis" by simulation, for every
way of compensating, on a stage that reads its drive; then other references and stages of other families.

Usage: docs/make_tracking_table.py [path of bodesmith]     (default build/bin/bodesmith; run ./run first)
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/bin/bodesmith")
FOLDER = "examples/nanopositioner"

# Table II, polynomial-based compensation: measured, percent of range.
PAPER = {1: 0.98, 10: 0.82, 20: 0.56, 30: 0.59, 40: 0.60, 50: 0.72, 60: 0.66, 70: 0.74, 80: 0.86, 90: 0.83, 100: 0.56,
         200: 0.85, 400: 1.02, 600: 1.08, 800: 0.95, 1000: 0.79, 1500: 1.32, 2000: 1.53, 2500: 1.38, 3000: 1.14,
         4000: 1.20, 5000: 1.49}
SHORT = {"none": "none", "polynomial": "constant", "cascade": "ideal cascade", "sections": "sections",
         "waveform": "waveform fit", "scheduled": "known frequency", "fpaa": "FPAA capacitors",
         "fpaa_with_holds": "FPAA with holds", "circuit": "E96 circuit",
         "two_passes": "two passes, constant", "two_passes_scheduled": "two passes, known frequency",
         "self_fed": "constant", "self_fed_sections": "sections", "self_fed_scheduled": "known frequency",
         "self_fed_slope": "measured slope", "self_fed_sum": "sections + known frequency",
         "self_fed_fpaa": "FPAA with holds", "self_fed_circuit": "E96 circuit",
         "controller_circuit": "analog controller, ngspice", "controller_cvode": "analog controller, CVODE",
         "controller_at_rest": "analog controller, closed form"}
FAMILY = {"polynomial": "polynomial, branch by slope", "polynomial_nested": "polynomial, closed minor loops",
          "preisach": "Preisach", "prandtl_ishlinskii": "Prandtl-Ishlinskii", "bouc_wen": "Bouc-Wen"}
ONE_PASS = ["none", "polynomial", "cascade", "sections", "scheduled", "fpaa_with_holds", "circuit"]

PAGE = """# Tracking from 1 Hz to 5 kHz, on a stage that reads its drive

Made by `docs/make_tracking_table.py`, which runs `bodesmith run` on `{folder}/table2.toml`, `seed.toml` and
`references.toml`: the stage of "Modeling and Control of Piezoelectric Hysteresis: A Polynomial-Based Fractional Order
Disturbance Compensation Approach" follows a reference in steady state. Figures are rms errors in percent of range (eq. 8
there), the best pure delay removed unless the head says otherwise, as in that paper's Table II, which is a measurement
(90 V peak to peak, polynomial-based) and has sensor noise, creep, and polynomials that fit the measured branches within
about 0.7 %. Here the generator has the stage's own polynomials.

## What changed

A stage adds the disturbance of its **drive**, y = v + K(f) d(v). The paper subtracts that of the reference, v = r - d(r).
Earlier editions of this page evaluated the stage on the reference too, and the two cancelled: {old_1hz:.3f} % at 1 Hz, where a
stage that reads its drive shows {new_1hz:.3f} % (the paper measured 0.98 %). The table has both, for the paper's design
(`seed.toml`): "formula" is the old evaluation (tracking option `Argument::reference`, columns `…_on_reference_percent`), "stage"
what a stage shows, nothing removed in either.

{both}

Three ways to make the drive:

| form | drive | left at 1 Hz |
|---|---|---|
| one pass, the paper | v = r - d(r) | {new_1hz:.3f} % |
| two passes | v = r - d(r - d(r)) | {two_1hz:.3f} % |
| fed by its own drive | v = r - d(v), a loop round the generator, no more multipliers | {loop_1hz:.3f} % |

and three to follow the rate: a linear filter in the branch (the paper's cascade, or one fitted to the waveform), a gain set
by the known frequency, a gain set by the measured slope of the reference (differentiator of 0.1 ms, rectifier).

## Full-stroke triangle, one pass

{one_pass}

## Full-stroke triangle, two passes, and fed by its own drive

The last columns are what `run` builds: *analog controller, ngspice* is `controller/controller.sub` (E96/E12 parts, op-amp, AD835 and switch
models) run in ngspice at every frequency, its drive given to the stage.

{more}

The same with nothing removed:

{more_with_lag}

## Other references, partial strokes, other families

Worst over {frequencies} Hz. The amplitude is known to the controller (gain and normalisation follow it), the stage's rate
gains are those of the reference's period. *two_tone* and *decaying_triangle* turn inside the stroke: the polynomial with the
branch by the slope alone jumps from branch to branch there, and so does a drive that follows it; with closed minor loops (and in the
other families) the stage remembers its turning points, which no polynomial generator does.
The other families are identified from the polynomial's loops (strokes of 1, 0.75, 0.5 and 0.25) at every frequency of their own; "fit"
is how far the model is from the full loop. No controller made of the polynomial can be better than that there, except by chance.

At partial strokes the figures of these stages, and of closed minor loops, are large for every controller, none included: a stage with
memory answers half the drive with more than half the stroke (with closed minor loops y(0.5) = 0.5 + d(0.5) = 0.553, as on the way up
to the full stroke), where the paper normalises each amplitude to its own displacement. No gain is removed here. Prandtl-Ishlinskii
begins each reference from its own rest instead of from a full stroke, which costs it most at 0.25. The emitted analog controller has the
full-stroke polynomials without amplitude gains: at partial strokes it is not made for the slope-rule stage.

{elsewhere}

What each way to follow the rate assumes when the reference is no triangle:

{assumed}

## How to read it

- **Up to 100 Hz** the stage's disturbance grows by the gains that the paper prints (Table I and its 10 Hz point).
- **From 200 Hz** the gains are not known (the paper's Fig. 10 is not printed as numbers). The stage keeps the gain of 100 Hz, and so do
  the gains by frequency or slope. So these rows show phase, lag and clock only.
- **From about 1 kHz** amplifier (100 kHz, assumed), damping compensator and resonance delay the stage by {lag_us:.2f} us: a triangle
  that is late by t is off by 2 f t of its height, {late_1k:.2f} % at 1 kHz and {late_5k:.2f} % at 5 kHz, whatever stands in front of it.
  With the delay removed what remains is the rounding of the triangle's corners.
- **FPAA with holds** is the compensator alone on the board, at the clocks of its plan; `bodesmith fpaa controller` places the whole
  controller there.

The program's own findings on table2.toml:

{findings}
"""


def run(project):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        done = subprocess.run([PROGRAM, "run", f"{FOLDER}/{project}", "-o", out, "--json"], capture_output=True, text=True,
                              cwd=ROOT)
        if done.returncode not in (0, 1):
            sys.exit(done.stderr)
        rows = list(csv.DictReader((out / "tracking.csv").open()))
        return rows, json.loads((out / "run.json").read_text())["tracking"]


def head_of(tracking, key):
    names = {d["key"]: d["name"] for d in tracking["designs"]}
    return SHORT.get(key, names.get(key, key))


def table(rows, tracking, keys, suffix, paper=True):
    keys = [k for k in keys if k + suffix in rows[0]]
    head = "| Hz | " + " | ".join(head_of(tracking, k) for k in keys) + (" | paper |" if paper else " |")
    lines = [head, "|" + "---|" * (len(keys) + 1 + paper)]
    for row in rows:
        hertz = float(row["frequency_hz"])
        cells = [f"{float(row[k + suffix]):.3f}" for k in keys] + ([f"{PAPER[int(hertz)]:.2f}"] if paper else [])
        lines.append(f"| {hertz:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def both_table(rows, tracking):
    keys = ["polynomial", "cascade", "sections", "scheduled", "fpaa_with_holds", "circuit"]
    keys = [k for k in keys if k + "_percent" in rows[0]]
    lines = ["| Hz | " + " | ".join(f"{head_of(tracking, k)}: formula | stage" for k in keys) + " | paper |",
             "|" + "---|" * (2 * len(keys) + 2)]
    for row in rows:
        cells = [f"{float(row[k + s]):.3f}" for k in keys for s in ("_on_reference_percent", "_percent")]
        lines.append(f"| {row['frequency_hz']} | " + " | ".join(cells) + f" | {PAPER[int(float(row['frequency_hz']))]:.2f} |")
    return "\n".join(lines)


def elsewhere_table(tracking):
    keys = [d["key"] for d in tracking["elsewhere"][0]["designs"]]
    main = {d["key"]: max(d["rms_percent_without_lag"]) for d in tracking["designs"]}
    title = {"polynomial": "one pass, constant", "cascade": "one pass, cascade", "self_fed": "self-fed, constant",
             "self_fed_sections": "self-fed, sections", "self_fed_scheduled": "self-fed, known frequency",
             "self_fed_slope": "self-fed, measured slope"}
    lines = ["| stage | reference | amplitude | fit | " + " | ".join(title.get(k, head_of(tracking, k)) for k in keys) + " |",
             "|" + "---|" * (len(keys) + 4)]
    lines.append(f"| {FAMILY['polynomial']} | {tracking['waveform']} | {tracking['amplitude']:g} | | "
                 + " | ".join(f"{main[k]:.2f}" for k in keys) + " |")
    for one in tracking["elsewhere"]:
        worst = {d["key"]: max(d["rms_percent_without_lag"]) for d in one["designs"]}
        fit = f"{max(one['fit_percent']):.2f}" if "fit_percent" in one else ""
        lines.append(f"| {FAMILY.get(one['stage'], one['stage'])} | {one['waveform']} | {one['amplitude']:g} | {fit} | "
                     + " | ".join(f"{worst[k]:.2f}" for k in keys) + " |")
    return "\n".join(lines)


def main():
    seed_rows, seed = run("seed.toml")
    rows, tracking = run("table2.toml")
    _, references = run("references.toml")
    first = seed_rows[0]
    keys = [d["key"] for d in tracking["designs"]]
    more = [k for k in keys if k not in ONE_PASS and k not in ("fpaa", "waveform")]
    slow = next(d for d in tracking["designs"] if d["key"] == "self_fed_scheduled")
    lag = slow["lag_s"][tracking["frequency_hz"].index(1000.0)]
    page = PAGE.format(
        folder=FOLDER, old_1hz=float(first["polynomial_on_reference_percent"]), new_1hz=float(first["polynomial_percent"]),
        two_1hz=float(first["two_passes_percent"]), loop_1hz=float(first["self_fed_percent"]),
        both=both_table(seed_rows, seed), one_pass=table(rows, tracking, ONE_PASS, "_without_lag_percent"),
        more=table(rows, tracking, more, "_without_lag_percent"),
        more_with_lag=table(rows, tracking, more, "_percent"),
        frequencies=", ".join(f"{f:g}" for f in references["frequency_hz"]), elsewhere=elsewhere_table(references),
        assumed="\n".join("- " + f for f in references["findings"] if f.startswith("Reference ")),
        lag_us=1e6 * lag, late_1k=2e5 * lag, late_5k=1e6 * lag,
        findings="\n".join("- " + f for f in tracking["findings"]))
    (ROOT / "docs/tracking_table.md").write_text(page)


main()
