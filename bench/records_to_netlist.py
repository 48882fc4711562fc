#!/usr/bin/env python3
"""From records to a netlist that tracks, on drawn stages that the program has never seen.

Draws stages (cubic branches, gains over frequency, strokes whose loop shrinks faster than they, an amplifier's lag, a sensor's
noise), takes their records at full strokes and shorter ones, has `bodesmith identify --disturbance` find polynomials and gains,
`bodesmith controller` build the circuit, ngspice run the netlist, and drives the drawn stage with what comes out. Stages are
simulated here. RMS tracking error in percent of the full range, the best pure delay removed, beside the same without a controller.

    bench/records_to_netlist.py --program build/bin/bodesmith --stages 10 --seed 1 --work DIR
"""
import argparse
import json
import math
import os
import random
import subprocess

FREQUENCIES = (1, 10, 20, 60, 100)
RECORDED = (0.75, 0.5, 0.35, 0.25)  # strokes of the records at the lowest frequency beside the full ones
PER_TURN = 400


def draw(rng):
    up = -rng.uniform(0.2, 0.38)
    up2 = rng.uniform(1.4, 2.0) * -up
    down = rng.uniform(0.15, 0.28)
    down2 = rng.uniform(-0.6, 0.3) * down
    gains, gain = [1.0], 1.0
    for _ in FREQUENCIES[1:]:
        gain = min(1.25, max(0.9, gain + rng.uniform(-0.05, 0.09)))
        gains.append(gain)
    return {"up": (up, up2, -up - up2), "down": (down, down2, -down - down2), "gains": gains,
            "shrink": rng.uniform(1.0, 1.4), "lag_s": rng.uniform(0, 3e-5), "noise": rng.uniform(0, 1e-3),
            "stroke": rng.uniform(2e-6, 2e-5), "offset": rng.uniform(-1e-6, 1e-6)}


def cubic(a, x):
    return x * (a[0] + x * (a[1] + x * a[2]))


def answer(stage, v, step, frequency, alpha):
    """The stage's output for a drive v(t) in full strokes, turns told by its slope (noise of a solver is none)."""
    k = stage["gains"][FREQUENCIES.index(frequency)]
    size = alpha ** stage["shrink"]
    tau = stage["lag_s"]
    keep = math.exp(-step / tau) if tau > 0 else 0.0
    out, late, low, high, rising = [], v[0], v[0], v[0], True
    for value in v:
        late = value + (late - value) * keep
        low, high = min(low, late), max(high, late)
        if rising and late < high - 0.002 * alpha:
            rising, low = False, late
        elif not rising and late > low + 0.002 * alpha:
            rising, high = True, late
        s = late / alpha
        out.append(late + (size * cubic(stage["up"], s) if rising else size * k * cubic(stage["down"], s)))
    return out


def triangle(turns, samples, alpha):
    out = []
    for i in range(turns * samples + 1):
        phase = (i % samples) / samples
        out.append(alpha * (2 * phase if phase < 0.5 else 2 - 2 * phase))
    return out


def write_record(stage, rng, path, frequency, alpha, turns=5):
    fine = 20
    drive = triangle(turns, PER_TURN * fine, alpha)
    y = answer(stage, drive, 1 / (frequency * PER_TURN * fine), frequency, alpha)
    with open(path, "w") as file:
        file.write("time_s,u,y\n")
        for i in range(turns * PER_TURN + 1):
            heard = stage["offset"] + stage["stroke"] * (y[i * fine] + rng.gauss(0, stage["noise"]))
            file.write(f"{i / (frequency * PER_TURN):.12g},{150 * drive[i * fine]:.12g},{heard:.12g}\n")


def drive_of_netlist(folder, frequency, alpha):
    period = 1 / frequency
    points = " ".join(f"{i * period / 2:.9g} {alpha * (i % 2):.9g}" for i in range(7))
    with open(os.path.join(folder, "track.cir"), "w") as file:
        file.write(f"""track
.include controller.sub
Vr r 0 PWL({points})
Xc r v controller
Rload v 0 1e6
.control
tran {period / 2000:.9g} {3 * period:.9g} 0 {period / 2000:.9g}
linearize v(v)
set wr_singlescale
wrdata track.txt v(v)
quit 0
.endc
.end
""")
    subprocess.run(["ngspice", "-n", "-b", "track.cir"], cwd=folder, check=True, capture_output=True)
    with open(os.path.join(folder, "track.txt")) as file:
        return [float(line.split()[1]) for line in file if line.strip()]


def left(y, alpha):
    """RMS in percent of the full range over the last period, the best delay of the reference removed; 2000 samples a period."""
    n = 2000
    y = y[-n:]
    best = math.inf
    for quarter in range(0, 80):
        late = quarter / 4
        total = 0.0
        for i, value in enumerate(y):
            phase = ((i + 1 - late) % n) / n
            total += (value - alpha * (2 * phase if phase < 0.5 else 2 - 2 * phase)) ** 2
        best = min(best, total / n)
    return 100 * math.sqrt(best)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--stages", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--track-hz", type=int, nargs="+", default=[1, 20, 100])
    parser.add_argument("--strokes", type=float, nargs="+", default=[1.0, 0.5, 0.25])
    parser.add_argument("--work", required=True)
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    rng = random.Random(options.seed)
    worst = {}
    refused = 0
    for number in range(options.stages):
        stage = draw(rng)
        folder = os.path.join(options.work, f"stage{number}")
        os.makedirs(folder, exist_ok=True)
        files = []
        for frequency in FREQUENCIES:
            files.append(f"f{frequency}.csv")
            write_record(stage, rng, os.path.join(folder, files[-1]), frequency, 1.0)
        for alpha in RECORDED:
            files.append(f"a{alpha}.csv")
            write_record(stage, rng, os.path.join(folder, files[-1]), FREQUENCIES[0], alpha)
        subprocess.run([program, "identify", *files, "--disturbance", "d.json", "--gains", "g.csv", "--quiet"],
                       cwd=folder, check=True, capture_output=True)
        found = json.load(open(os.path.join(folder, "d.json")))
        gain_error = max(abs(a - b) for a, b in zip(found["rate"]["descending"], stage["gains"]))
        made = subprocess.run([program, "controller", "d.json", "--track-hz", *map(str, options.track_hz), "-o", ".", "--quiet"],
                              cwd=folder, capture_output=True, text=True)
        if made.returncode != 0:
            refused += 1
            print(f"stage {number}: {made.stderr.strip()}", flush=True)
            continue
        cells = []
        for alpha in options.strokes:
            for frequency in options.track_hz:
                v = drive_of_netlist(folder, frequency, alpha)
                with_it = left(answer(stage, v, 1 / (frequency * 2000), frequency, alpha), alpha)
                without = left(answer(stage, triangle(3, 2000, alpha), 1 / (frequency * 2000), frequency, alpha), alpha)
                cells.append(f"{alpha}/{frequency} Hz {with_it:.3f} ({without:.2f})")
                worst[alpha] = max(worst.get(alpha, 0.0), with_it)
        print(f"stage {number}: gains within {gain_error:.4f}; " + ", ".join(cells), flush=True)
    print(f"{options.stages - refused} of {options.stages} stages tracked")
    for alpha, value in worst.items():
        print(f"worst at stroke {alpha}: {value:.3f} % of the full range")


if __name__ == "__main__":
    main()
