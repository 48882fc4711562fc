#!/usr/bin/env python3
"""How often experiment.csv resolves a tie, blind.

Draws systems with one hidden effect and a poor record (one sine, or a slow triangle), asks `bodesmith diagnose` what is missing, keeps
the cases whose answer is a tie with the right one in it, drives the true system with experiment.csv (simulated here, noise
added), and asks again with that record beside the first. Resolved: the hidden effect is named and nothing is tied with it.

    bench/experiment_ties.py --program build/bin/bodesmith --ties 50 --seed 1 --jobs 1 --work DIR
"""
import argparse
import json
import math
import os
import random
import subprocess
from concurrent.futures import ThreadPoolExecutor

FINE = 20  # steps inside a sample


def fine(x):
    out = []
    for a, b in zip(x, x[1:]):
        out += [a + (b - a) * j / FINE for j in range(FINE)]
    return out + [x[-1]]


def lag(x, step, hz):
    a = 2 * math.pi * hz * step
    e = math.exp(-a)
    g = (1 - e) / a
    y = [0.0]
    for u, v in zip(x, x[1:]):
        y.append(e * y[-1] + (g - e) * u + (1 - g) * v)
    return y


def delayed(x, step, seconds):
    out = []
    for i in range(len(x)):
        at = i - seconds / step
        if at <= 0:
            out.append(x[0])
            continue
        k = int(at)
        out.append(x[k] + (x[min(k + 1, len(x) - 1)] - x[k]) * (at - k))
    return out


def play(x, width):
    out, state = [], 0.0
    for v in x:
        state = max(v - width / 2, min(v + width / 2, state))
        out.append(state)
    return out


def slewed(x, step, rate):
    out = [0.0]
    for v in x[1:]:
        out.append(out[-1] + max(-rate * step, min(rate * step, v - out[-1])))
    return out


def on_fine(f):
    return lambda x, step: f(fine(x), step / FINE)[::FINE]


GAIN = '[[block]]\ntype = "gain"\ngain = 1.0\nfree = ["gain"]\n'
OFFSET = '[[block]]\ntype = "gain"\ngain = 1.0\noffset = 0.0\nfree = ["gain", "offset"]\n'


def drawn(r):
    """(name, base model, system, frequency of the record, amplitude)"""
    hz = math.exp(r.uniform(math.log(2), math.log(30)))
    gain = r.uniform(0.8, 1.2)
    phase = r.uniform(0.03, 0.3)  # rad that the effect turns the record's sine by
    kind = r.choice(["time_delay", "amplifier_pole", "backlash", "saturation", "cubic_nonlinearity", "dead_zone", "slew_limit"])
    if kind == "time_delay":
        t = phase / (2 * math.pi * hz)
        return kind, GAIN, lambda x, h: [gain * v for v in delayed(x, h, t)], hz
    if kind == "amplifier_pole":
        corner = hz / math.tan(phase)
        return kind, GAIN, on_fine(lambda x, h: [gain * v for v in lag(x, h, corner)]), hz
    if kind == "backlash":
        width = r.uniform(0.1, 0.4)
        return kind, GAIN, on_fine(lambda x, h: [gain * v for v in play(x, width)]), hz
    if kind == "saturation":
        top = r.uniform(0.7, 0.95)
        return kind, OFFSET, lambda x, h: [gain * max(-top, min(top, v)) for v in x], hz
    if kind == "cubic_nonlinearity":
        c = r.uniform(0.03, 0.2)
        return kind, OFFSET, lambda x, h: [gain * (v - c * v**3) for v in x], hz
    if kind == "dead_zone":
        w = r.uniform(0.1, 0.5)
        return kind, GAIN, lambda x, h: [gain * (v - w / 2 if v > w / 2 else v + w / 2 if v < -w / 2 else 0.0) for v in x], hz
    rate = 2 * math.pi * hz * r.uniform(0.75, 0.95)
    return kind, GAIN, on_fine(lambda x, h: [gain * v for v in slewed(x, h, rate)]), hz


def write(path, step, u, y):
    with open(path, "w") as f:
        f.write("time_s,u,y\n")
        for i, (a, b) in enumerate(zip(u, y)):
            f.write(f"{i * step:.9g},{a:.7g},{b:.7g}\n")


def record(r, hz, shape, samples, step):
    if shape == "sine":
        return [math.sin(2 * math.pi * hz * i * step) for i in range(samples)]
    cycles = [hz * i * step % 1 for i in range(samples)]
    return [4 * c if c < 0.25 else 2 - 4 * c if c < 0.75 else 4 * c - 4 for c in cycles]


def diagnose(args, model, data, out, rate):
    faster = ["--drive-max-rate", str(rate * args.faster)] if args.faster != 1 else []
    subprocess.run([args.program, "diagnose", model, "--data", *data, "-o", out, "--threads", "1", "--max-seconds", "60", *faster],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(out + "/diagnosis.json") as f:
        return json.load(f)


def answer(d):
    """(names, names and everything tied with them)"""
    named = [s["effect"] for s in d["steps"]]
    return named, [named, *[s["tied_with"] for s in d["steps"]]]


def one(args, number):
    r = random.Random(args.seed * 100003 + number)
    kind, base, system, hz = drawn(r)
    samples, step = 400, 1 / (hz * r.uniform(60, 120))
    u = record(r, hz, r.choice(["sine", "sine", "triangle"]), samples, step)
    y = system(u, step)
    rate = max(abs(b - a) for a, b in zip(u, u[1:])) / step
    noise = 10 ** r.uniform(-2.3, -1.3)
    folder = f"{args.work}/{number}"
    os.makedirs(folder, exist_ok=True)
    with open(folder + "/model.toml", "w") as f:
        f.write('schema = "bodesmith.model/1"\n' + base)
    write(folder + "/first.csv", step, u, [v + r.gauss(0, noise) for v in y])
    first = diagnose(args, folder + "/model.toml", [folder + "/first.csv"], folder + "/out1", rate)
    named, _ = answer(first)
    tied = [t for s in first["steps"] for t in s["tied_with"]]
    if not tied or kind not in named + tied or not os.path.exists(folder + "/out1/experiment.csv"):
        return None
    with open(folder + "/out1/experiment.csv") as f:
        rows = [line.split(",") for line in f.read().splitlines()[1:]]
    drive = [float(row[1]) for row in rows]
    h = float(rows[1][0]) - float(rows[0][0])
    write(folder + "/second.csv", h, drive, [v + r.gauss(0, noise) for v in system(drive, h)])
    second = diagnose(args, folder + "/model.toml", [folder + "/first.csv", folder + "/second.csv"], folder + "/out2", rate)
    after, _ = answer(second)
    left = [t for s in second["steps"] for t in s["tied_with"]]
    return {"case": number, "hidden": kind, "noise": noise, "first": named, "tied": tied,
            "separates": first["experiment"]["separates"], "drive": first["experiment"]["drive"],
            "over_noise": first["experiment"]["difference_over_noise"], "second": after, "left": left,
            "resolved": kind in after and not left}


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--program", required=True)
    p.add_argument("--ties", type=int, default=50)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--jobs", type=int, default=1)
    p.add_argument("--faster", type=float, default=1, help="the drive may be so many times as fast as the record")
    p.add_argument("--work", required=True)
    args = p.parse_args()
    found, tried = [], 0
    with ThreadPoolExecutor(args.jobs) as pool:
        while len(found) < args.ties and tried < 40 * args.ties:
            batch = range(tried, tried + 4 * args.jobs)
            tried += len(batch)
            for result in pool.map(lambda n: one(args, n), batch):
                if result is None:
                    continue
                found.append(result)
                words = "resolved" if result["resolved"] else "NOT"
                print(f"{result['case']:4} {words:8} {result['hidden']:20} tie {result['first']}+{result['tied']} -> "
                      f"{result['second']}+{result['left']} ({result['drive']}, {result['over_noise']:.3g} x noise)", flush=True)
    good = sum(f["resolved"] for f in found)
    print(f"{good} of {len(found)} ties resolved ({tried} cases drawn)")


if __name__ == "__main__":
    main()
