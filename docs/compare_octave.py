#!/usr/bin/env python3
"""Makes docs/comparisons.md: direct fits and simulations against Octave and ngspice, all in one run.

Usage: docs/compare_octave.py [path of bodesmith]     (needs octave, octave-signal, octave-control, ngspice)
"""
import json
import math
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/bin/bodesmith")


def run(*command, cwd=None):
    environment = dict(os.environ, QT_QPA_PLATFORM="offscreen")
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, cwd=cwd, env=environment)
    if done.returncode != 0:
        sys.exit(f"{command[0]}: {done.stdout}{done.stderr}")
    return done.stdout


def octave(script):
    return run("octave", "--quiet", "--no-gui", "--eval", script)


# ---- direct fits ----------------------------------------------------------------------------------------------------

INVFREQS = """
pkg load signal
warning('off', 'all');
s = 1i*w;
%s
for n = [%s]
  %% weights 1/|H|^2 make the fit relative; iterations as Sanathanan and Koerner
  scale = sqrt(w(1)*w(end));
  [b, a] = invfreqs(H, w/scale, n, n, 1./abs(H).^2, 30);
  G = polyval(b, s/scale) ./ polyval(a, s/scale);
  p = roots(a);
  printf('%%d %%.6g %%d\\n', n, max(abs(20*log10(abs(G./H)))), all(real(p) < 0));
end
"""

CURVES = {
    "RIAA playback": ("riaa", "H = (1+318e-6*s)./((1+3180e-6*s).*(1+75e-6*s));", [2, 4]),
    "A-weighting": ("a_weighting", "H = s.^4./((s+129.4).^2.*(s+676.7).*(s+4636).*(s+76655).^2);", [4, 6]),
    "pink noise slope": ("pink_noise", "H = s.^-0.5;", [4, 6, 8]),
}


def fits(folder):
    rows = ["| curve | order | bodesmith fit --direct, dB | invfreqs, dB | invfreqs stable |", "|---|---|---|---|---|"]
    for name, (example, response, orders) in CURVES.items():
        points = ROOT / "examples" / example / "points.csv"
        lines = [line for line in points.read_text().splitlines() if line and not line.startswith("#")][1:]
        w = [2 * math.pi * float(line.split(",")[0]) for line in lines]
        script = "w = [" + ";".join(repr(x) for x in w) + "];\n" + INVFREQS % (response, " ".join(map(str, orders)))
        peer = {int(n): (float(db), stable == "1") for n, db, stable in map(str.split, octave(script).split("\n")[:-1])}
        for order in orders:
            out = folder / "fitted.json"
            run(PROGRAM, "fit", points, "--direct", "--order", order, "-o", out)
            db = json.loads(out.read_text())["error"]["max_magnitude_db"]
            stable = "yes" if peer[order][1] else "no"
            rows.append(f"| {name} | {order} | {db:.3g} | {peer[order][0]:.3g} | {stable} |")
    return "\n".join(rows)


# ---- simulation -----------------------------------------------------------------------------------------------------

# The sections that the paper prints (eq. 21-24, its pole 625.1 read as 652.1), each of gain 1 at DC.
ZEROS = [48.79, 14.8, 107.6, 63.68, 380.2, 221.6, 400.0, 365.6]
POLES = [47.49, 13.99, 126.4, 102.2, 214.9, 124.8, 652.1, 589.4]
FREQUENCY = 100.0
SECONDS = 1.0

LSIM = """
pkg load control
warning('off', 'all');
z = [%s]; p = [%s];
sys = ss(zpk(-z, -p, prod(p)/prod(z)));
for n = [%s]
  t = (0:n)'/n;
  u = 1 - abs(mod(2*%g*t, 2) - 1);
  took = [];
  for k = 1:3
    tic; y = lsim(sys, u, t); took(end+1) = toc;
  end
  printf('%%d %%.9g', n, median(took));
  for i = round(linspace(0, n, 1001))
    printf(' %%.17g', y(i+1));
  end
  printf('\\n');
end
"""


def triangle(t):
    part = (t * FREQUENCY) % 1.0
    return 2.0 * part if part < 0.5 else 2.0 - 2.0 * part


class ClosedForm:
    """y = direct u + sum of modes r/(s - p), each mode exactly, from corner to corner of the triangle."""

    def __init__(self):
        self.gain = math.prod(POLES) / math.prod(ZEROS)
        self.residues = []
        for i, p in enumerate(POLES):
            top = math.prod(z - p for z in ZEROS)
            bottom = math.prod(q - p for k, q in enumerate(POLES) if k != i)
            self.residues.append(self.gain * top / bottom)
        half = 0.5 / FREQUENCY
        self.corners = [[0.0] * len(POLES)]
        for k in range(round(SECONDS / half)):
            self.corners.append(self.modes(k, half))

    def line(self, k):
        slope = 2.0 * FREQUENCY
        return (0.0, slope) if k % 2 == 0 else (1.0, -slope)

    def modes(self, k, tau):
        a, b = self.line(k)
        out = []
        for x, q in zip(self.corners[k], POLES):
            rest = a / q - b / (q * q)
            out.append((x - rest) * math.exp(-q * tau) + rest + b * tau / q)
        return out

    def __call__(self, t):
        half = 0.5 / FREQUENCY
        k = min(int(t / half + 1e-9), len(self.corners) - 1)
        states = self.modes(k, t - k * half)
        return self.gain * triangle(t) + sum(r * x for r, x in zip(self.residues, states))


def ours(folder, engine, samples, tolerance):
    out = folder / "y.csv"
    best = []
    for _ in range(5):
        summary = json.loads(
            run(PROGRAM, "simulate", folder / "model.toml", "--reference", "triangle", "--frequency-hz", FREQUENCY,
                "--step-s", repr(SECONDS / samples), "--engine", engine, "--tolerance", tolerance,
                "--no-error-estimate", "-o", out, "--json"))
        best.append(summary["timing_s"]["engine"])
    lines = out.read_text().splitlines()[1:]
    return statistics.median(best), [tuple(float(c) for c in (line.split(",")[0], line.split(",")[2]))
                                     for line in lines[:: max(1, samples // 1000)]]


def spice(folder):
    """ngspice on the netlist that bodesmith emits for the same sections: exact parts, ideal op-amps."""
    sections = {"schema": "bodesmith.sections/1", "gain": math.prod(POLES) / math.prod(ZEROS),
                "sections": [{"gain": 1.0, "zeros_rad_s": [[-z, 0]], "poles_rad_s": [[-p, 0]]}
                             for z, p in zip(ZEROS, POLES)]}
    (folder / "sections.json").write_text(json.dumps(sections))
    run(PROGRAM, "spice", folder / "sections.json", "-o", folder / "spice", "--series", "exact", "--opamp", "ideal")
    half = 0.5 / FREQUENCY
    (folder / "spice/deck.cir").write_text(
        "triangle through the emitted netlist\n.include compensator.sub\n"
        f"Vin in 0 PULSE(0 1 0 {half} {half} 1e-12 {2 * half})\nXc in out compensator\nRload out 0 1e6\n"
        ".options reltol=1e-6 abstol=1e-15 vntol=1e-10\n"
        f".control\ntran 1e-5 {SECONDS} 0 1e-5\nset wr_singlescale\nset numdgt=15\nwrdata out.txt v(out)\nquit 0\n"
        ".endc\n.end\n")
    start = time.monotonic()
    run("ngspice", "-b", "deck.cir", cwd=folder / "spice")
    took = time.monotonic() - start
    points = [tuple(map(float, line.split()[:2])) for line in (folder / "spice/out.txt").read_text().splitlines()[1:]]
    return took, points


def error(points, exact):
    return max(abs(y - exact(t)) for t, y in points)


def simulations(folder):
    blocks = "".join(f'[[block]]\ntype = "pole_zero"\nzero_hz = {z / (2 * math.pi)!r}\npole_hz = {p / (2 * math.pi)!r}\n'
                     for z, p in zip(ZEROS, POLES))
    (folder / "model.toml").write_text('schema = "bodesmith.model/1"\n' + blocks)
    exact = ClosedForm()
    rows = []
    for name, engine, samples, tolerance in [("bodesmith, exact", "exact", 10**5, "1e-8"),
                                             ("bodesmith, exact", "exact", 10**6, "1e-8"),
                                             ("bodesmith, sample to sample", "record", 10**5, "1e-8"),
                                             ("bodesmith, CVODE at 1e-6", "cvode", 10**4, "1e-6"),
                                             ("bodesmith, CVODE at 1e-9", "cvode", 10**4, "1e-9")]:
        took, points = ours(folder, engine, samples, tolerance)
        rows.append((name, samples, took, error(points, exact)))
    sizes = [10**5, 10**6]
    text = octave(LSIM % (" ".join(map(repr, ZEROS)), " ".join(map(repr, POLES)), " ".join(map(str, sizes)), FREQUENCY))
    for line in text.splitlines():
        cells = line.split()
        points = [(i / 1000.0, float(y)) for i, y in enumerate(cells[2:])]
        rows.append(("Octave, lsim", int(cells[0]), float(cells[1]), error(points, exact)))
    took, points = spice(folder)
    rows.append(("ngspice, emitted netlist, whole process", len(points), took, error(points, exact)))
    first = rows[0]
    table = ["| | samples | time, ms | times the first | largest error | of the first |", "|---|---|---|---|---|---|"]
    for name, samples, took, off in rows:
        table.append(f"| {name} | {samples:.3g} | {1e3 * took:.3g} | {took / first[2]:.3g} | {off:.2g} | "
                     f"{off / first[3]:.2g} |")
    return "\n".join(table)


PAGE = """# Comparisons with other programs

Made by `docs/compare_octave.py` in one run on {machine}.

## Direct fits

Octave's `invfreqs` (signal) gets the exact minimum-phase response, `fit --direct` the magnitudes alone. Largest error in
dB at the points of the examples. Where the curve is rational and its phase is given, `invfreqs` is exact; where it is not,
or the poles lie far apart, it is far off.

{fits}

## Simulation

The eight sections that "Modeling and Control of Piezoelectric Hysteresis: A Polynomial-Based Fractional Order Disturbance Compensation Approach" prints, 100 Hz triangle of height 1 from rest, 1 s. The reference for the errors is
the closed form, mode by mode, computed in the script; for this input `lsim` is exact too.
Wall times on a shared machine, so the ratios say more than the times: of `simulate`'s engine and of `lsim` alone (median of five, of three for `lsim`), of ngspice the whole process with
`reltol` 1e-6 and steps of at most 10 us. Its netlist is the one that `spice --series exact --opamp ideal` emits for the
same sections. The speed of all eight poles behind the switched cubic is in `bench/simulate_speed.cpp`.

{simulations}
"""


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        page = PAGE.format(machine=f"{platform.machine()}, {os.cpu_count()} cores", fits=fits(folder),
                           simulations=simulations(folder))
    (ROOT / "docs/comparisons.md").write_text(page)


main()
