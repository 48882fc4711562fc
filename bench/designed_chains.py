#!/usr/bin/env python3
"""Faults hidden in designed circuits: is the name right, and at the right stage?

Each case designs a filter (`design`, or `fit --direct` to a drawn curve), builds it (`spice`), makes the model of what was built
(`model circuit.json`) and hides one fault in the netlist: a capacitor off, an op-amp a few times too slow, the input held by a clock. A
quarter of the cases is a controlled stage instead (polynomial branches and a filter behind them, simulated here): a branch switch that
is late, a multiplier's scale. ngspice runs the netlist; white noise is added, the fault's trace 5 to 40 times as large. `diagnose` is
asked by records of time. (`--faults none`: controls.)

    bench/designed_chains.py --program build/bin/bodesmith --cases 100 --seed 1 --work DIR
"""
import argparse
import json
import math
import os
import random
import re
import subprocess

import numpy as np

from hidden_effects import block_text, drive

SAMPLES = 900
FAULTS = ["capacitor_mismatch", "capacitor_mismatch", "opamp_bandwidth", "sample_hold", "switch_delay", "multiplier_error"]


def command(program, folder, *words):
    done = subprocess.run([program, *words], cwd=folder, capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise RuntimeError(" ".join(words) + ": " + done.stderr.strip())
    return done.stdout


def designed(rng, program, folder, kind):
    """Sections of a filter whose corner is returned, Hz."""
    corner = math.exp(rng.uniform(math.log(50), math.log(5000)))
    if kind == "curve":  # a rise and falls, real poles and zeros
        f = np.geomspace(corner / 10, corner * 10, 60)
        gain = np.ones(60)
        for _ in range(rng.randint(2, 3)):
            z, p = corner * 10 ** rng.uniform(-.7, .7), corner * 10 ** rng.uniform(-.7, .7)
            gain = gain * np.abs((1 + 1j * f / z) / (1 + 1j * f / p))
        with open(folder + "/points.csv", "w") as out:
            out.write("frequency_hz,gain\n" + "".join(f"{a:.9g},{b:.9g}\n" for a, b in zip(f, gain)))
        command(program, folder, "fit", "points.csv", "--direct", "--order", str(rng.randint(2, 3)), "--real", "-o", "sections.json")
        return corner
    family = rng.choice(["butterworth", "bessel", "chebyshev1"])
    words = ["design", kind, "--family", family, "--order", str(rng.randint(2, 3) if kind != "bandpass" else 2), "-o", "sections.json"]
    words += ["--from-hz", str(corner / 2), "--to-hz", str(corner * 2)] if kind == "bandpass" else ["--corner-hz", str(corner)]
    command(program, folder, *words, *(["--ripple-db", "1"] if family == "chebyshev1" else []))
    return corner


def with_fault(rng, netlist, fault, corner):
    """The netlist with it, and the number of the stage in which it is."""
    lines = netlist.split("\n")
    at, stage = None, None
    places = []
    for k, line in enumerate(lines):
        found = re.match(r"\.subckt compensator_stage(\d+)", line)
        if found:
            stage = int(found.group(1))
        if stage and re.match(r"C\w+ ", line) and fault == "capacitor_mismatch":
            places.append((k, stage))
        if stage and "bodesmith_opamp" in line and line.startswith("XU") and fault == "opamp_bandwidth":
            places.append((k, stage))
        if line.startswith(".ends"):
            stage = None
    if fault in ("sample_hold", "none"):
        return netlist, None, None
    if not places:
        return None
    at, stage = rng.choice(places)
    if fault == "capacitor_mismatch":
        words = lines[at].split()
        off = math.exp(rng.choice([-1, 1]) * rng.uniform(.05, .2))
        words[3] = repr(float(words[3]) * off)
        lines[at] = " ".join(words)
        return "\n".join(lines), stage, f"{words[0]} x {off:.3f}"
    gbw = corner * rng.uniform(15, 60)
    body = netlist[netlist.index(".subckt bodesmith_opamp"):netlist.index(".ends bodesmith_opamp")]
    slow = body.replace("bodesmith_opamp", "slow_opamp")
    # A smaller slope of the input, a greater resistor: the DC gain and the slew rate stay.
    slow = re.sub(r"tanh\(([\d.]+)\*", lambda m: f"tanh({float(m.group(1)) * gbw / 1e7:.9g}*", slow)
    slow = re.sub(r"Rx x 0 (\S+)", lambda m: f"Rx x 0 {float(m.group(1)) * 1e7 / gbw:.9g}", slow) + ".ends slow_opamp"
    lines[at] = lines[at].replace("bodesmith_opamp", "slow_opamp")
    return "\n".join(lines) + "\n" + slow + "\n", stage, f"{lines[at].split()[0]} at {gbw:.4g} Hz"


def by_ngspice(folder, netlist, u, step, clock=None):
    """v(out) at the samples for the drive u, linear between its samples, or held by a clock."""
    t = np.arange(len(u)) * step
    if clock:
        edges = np.arange(0, t[-1], 1 / clock)
        values = np.interp(edges, t, u)
        t = np.concatenate([[0.0], np.repeat(edges[1:], 2) + np.tile([-1e-3, 1e-3], len(edges) - 1) * step, [t[-1]]])
        points = " ".join(f"{a:.12g} {b:.12g}" for a, b in zip(t, np.repeat(values, 2)))
    else:
        points = " ".join(f"{a:.12g} {b:.12g}" for a, b in zip(t, u))
    points = re.sub(r"((?:\S+ ){16})", r"\1\n+ ", points)
    deck = (f"designed chain\n{netlist}\nVin in 0 PWL({points})\nX0 in out compensator\nRl out 0 1e9\n.options reltol=1e-5 abstol=1e-13 vntol=1e-9\n"
            f".control\ntran {step / 8:.9g} {(len(u) - 1) * step:.12g} 0 {step / 8:.9g}\nwrdata out.data v(out)\nquit\n.endc\n.end\n")
    with open(folder + "/deck.cir", "w") as f:
        f.write(deck)
    subprocess.run(["ngspice", "-b", "deck.cir"], cwd=folder, capture_output=True, timeout=300)
    t, v = np.loadtxt(folder + "/out.data", usecols=(0, 1), unpack=True)
    os.remove(folder + "/out.data")
    return np.interp(np.arange(len(u)) * step, t, v)


def stage_case(rng, folder, fault, high):
    """A stage of branches with a lag behind it; drives, records with and without the fault."""
    up = [rng.uniform(.05, .2), rng.uniform(-.15, .15), rng.uniform(-.1, .1)]
    down = [-rng.uniform(.05, .2), rng.uniform(-.15, .15), rng.uniform(-.1, .1)]
    pole = high * rng.uniform(2, 6)
    with open(folder + "/model.toml", "w") as f:
        f.write('schema = "bodesmith.model/1"\n' + block_text("polynomial_hysteresis", [], ascending=up, descending=down) +
                block_text("lowpass", [], corner_hz=pole))
    scale, late = (rng.choice([-1, 1]) * rng.uniform(.05, .2), 0.0) if fault == "multiplier_error" else (0.0, rng.uniform(.02, .1) / high)

    def run(u, step, on):
        fine = 16
        h = step / fine
        x = np.interp(np.arange((len(u) - 1) * fine + 1) / fine, np.arange(len(u)), u)
        m = 1 + on * scale
        polynomial = lambda a, v: v + v * (a[0] + v * (a[1] * m + v * a[2] * m * m))
        # A stretch between two points of the grid has one branch: it jumps at the turn, not within the stretch behind it.
        rising = np.diff(x)
        for i in range(1, len(rising)):
            rising[i] = rising[i] or rising[i - 1]
        rising = np.concatenate([np.full(round(on * late / h), rising[0]), rising])[:len(x) - 1] >= 0
        ends = [np.where(rising, polynomial(up, v), polynomial(down, v)) for v in (x[:-1], x[1:])]
        e = math.exp(-2 * math.pi * pole * h)
        g = (1 - e) / (2 * math.pi * pole * h)
        y = np.zeros(len(x))
        for i in range(1, len(x)):
            y[i] = e * y[i - 1] + (g - e) * ends[0][i - 1] + (1 - g) * ends[1][i - 1]
        return y[::fine]

    return run, f"scale {1 + scale:.3f}" if scale else f"late {late:.4g} s"


def make(rng, program, folder, fault):
    os.makedirs(folder, exist_ok=True)
    truth = {"fault": fault}
    if fault in ("switch_delay", "multiplier_error"):
        high = math.exp(rng.uniform(math.log(5), math.log(500)))
        run, truth["what"] = stage_case(rng, folder, fault, high)
        truth["stage"] = None
    else:
        kind = rng.choice(["lowpass", "highpass", "bandpass", "curve", "curve"])
        high = 2 * designed(rng, program, folder, kind)
        command(program, folder, "spice", "sections.json", "-o", "spice")
        command(program, folder, "model", "spice/circuit.json", "-o", "model.toml")
        netlist = open(folder + "/spice/compensator.sub").read()
        faulty = with_fault(rng, netlist, fault, high / 2)
        if faulty is None:
            return make(rng, program, folder, fault)
        truth["kind"], truth["stage"], truth["what"] = kind, faulty[1], faulty[2]
        clock = high * rng.uniform(6, 20)
        if fault == "sample_hold":
            truth["what"] = f"clock {clock:.5g} Hz"

        def run(u, step, on):
            return by_ngspice(folder, faulty[0] if on else netlist, u, step, clock if on and fault == "sample_hold" else None)

    low, step = high / rng.uniform(6, 15), 1 / (high * rng.uniform(18, 35))
    branched = truth["stage"] is None and fault != "sample_hold"
    shapes = ["multisine", "triangles", "two_tone", "sweep"] + ([] if branched else ["noise", "steps"])
    times = math.exp(rng.uniform(math.log(5), math.log(40)))
    truth["times"] = times
    sigma = None
    for name, speed in zip("abh", (1.0, rng.uniform(.3, .7), .8)):
        u = drive(rng, rng.choice(shapes), SAMPLES, step, low * speed, high * speed, 1.0)
        if branched:
            u = (u - u.min()) / (u.max() - u.min()) * .95
            u = np.concatenate([u[0] * np.linspace(0, 1, 60), u])
        y, good = run(u, step, 1), run(u, step, 0)
        sigma = sigma or (math.sqrt(np.mean((y - good) ** 2)) if fault != "none" else .05 * np.std(y)) / times
        y = y + sigma * np.array([rng.gauss(0, 1) for _ in y])
        with open(f"{folder}/{name}.csv", "w") as out:
            out.write("time_s,u,y\n" + "".join(f"{i * step:.12g},{a:.10g},{b:.10g}\n" for i, (a, b) in enumerate(zip(u, y))))
    truth["sigma"] = sigma
    return truth


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--cases", type=int, default=24)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--faults", default=",".join(FAULTS))
    parser.add_argument("--work", required=True)
    args = parser.parse_args()
    program = os.path.abspath(args.program)
    count = {}
    for i in range(args.cases):
        faults = args.faults.split(",")
        fault = faults[i % len(faults)]
        folder = os.path.abspath(f"{args.work}/{i}")
        truth = make(random.Random(f"designed chains {args.seed} {i}"), program, folder, fault)
        command(program, folder, "diagnose", "model.toml", "--data", "a.csv", "b.csv", "--holdout", "h.csv", "-o", "out")
        d = json.load(open(folder + "/out/diagnosis.json"))
        model = open(folder + "/model.toml").read()
        names = re.findall(r'name = "(\w+)"', model)
        said = []
        for s in d["steps"]:
            where = re.search(r"block (\d+)", s["placed"])
            said.append((s["effect"], s["tied_with"], names[int(where.group(1)) - 1] if where and names else s["placed"], round(s["probability"], 2)))
        if fault == "none":  # nothing may be named
            said, fault = [("none", [], "Stage", 1.0)] if not said else said, "none"
        right = [s for s in said if s[0] == fault]
        placed = bool(right) and (truth["stage"] is None or right[0][2].startswith(f"Stage{truth['stage']}"))
        tied = any(fault in s[1] for s in said)
        ok = count.setdefault(fault, [0, 0, 0, 0, 0])
        for k, v in enumerate((1, bool(right), placed, tied and not right, len(said) > 1)):
            ok[k] += v
        print(i, fault, truth.get("kind", ""), truth["stage"], truth["what"], f"{truth['times']:.1f}", "->", d["verdict"], said,
              "" if right and placed else "PLACE" if right else "tied" if tied else "MISSED", flush=True)
    print("fault: cases, named, at its place, tied, with extra names")
    for fault, c in sorted(count.items()):
        print(f"{fault:20s}", *c)


if __name__ == "__main__":
    main()
