#!/usr/bin/env python3
"""A bench in place of one's own: hardware as it was soldered, measured. Reads the netlists that `bodesmith run` wrote and
nothing else; its equations are its own (nodes solved by elimination, Runge-Kutta), so that what it hides must be found.

    bench.py circuit RUN -o bode.csv [PART=FACTOR ...]
        frequency response of RUN/spice/compensator.sub, one-pole op-amps
    bench.py controller RUN -o record.csv [PART=FACTOR ...] [--amplifier-hz F] [--switch-late-s T] [--frequency-hz F]
               [--stage-falling K] [--stage-bend B] [--resonance-hz F]
        RUN/controller/controller.sub in front of the nanopositioner: a full-stroke triangle and the displacement

PART=FACTOR solders another value: R2_1=1.1 is ten percent too much.
"""

import argparse
import bisect
import cmath
import csv
import json
import math
import random
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


class Netlist:
    """One .subckt laid flat: resistors and capacitors, op-amps and multipliers by node."""

    def __init__(self, path, top, changed):
        self.text = Path(path).read_text().splitlines()
        self.passive, self.opamps, self.multipliers, self.sources = {}, [], {}, {}
        self._lay(top, {}, "")
        unknown = set(changed) - set(self.passive)
        if unknown:
            sys.exit(f"bench: {path}: no part {sorted(unknown)[0]}")
        for name, factor in changed.items():
            a, b, value = self.passive[name]
            self.passive[name] = (a, b, value * factor)

    def _lay(self, name, pins, prefix):
        inside = False
        for line in self.text:
            words = line.split()
            if line.startswith(".subckt ") and words[1] == name:
                inside, ports = True, words[2:]
            elif inside and line.startswith(".ends"):
                return
            elif inside and words and words[0][0] not in "*.":
                def node(n):
                    return pins.get(n, n) if n in ports or n == "0" else prefix + n

                element, nodes = words[0], words[1:]
                if element[0] in "RC":
                    self.passive[element] = (node(nodes[0]), node(nodes[1]), float(nodes[2]))
                elif element[0] == "V":
                    self.sources[node(nodes[0])] = float(nodes[2])
                elif element[0] == "X" and nodes[-1].endswith("opamp"):
                    self.opamps.append(tuple(node(n) for n in nodes[:3]))
                elif element[0] == "X" and nodes[-1].endswith("multiplier"):
                    self.multipliers[node(nodes[3])] = tuple(node(n) for n in nodes[:3])
                elif element[0] == "X" and not nodes[-1].endswith("switch"):
                    inner = [line.split()[2:] for line in self.text if line.startswith(f".subckt {nodes[-1]} ")][0]
                    self._lay(nodes[-1], dict(zip(inner, map(node, nodes[:-1]))), element + ".")

    def value(self, name):
        return self.passive[name][2]

    def at(self, node):
        """(other node, conductance) of every resistor there."""
        for name, (a, b, value) in self.passive.items():
            if name[0] == "R" and node in (a, b):
                yield (b if a == node else a), 1.0 / value

    def sum(self, out):
        """Output of the op-amp that sums resistors' voltages, as a function of them: an ideal op-amp with one feedback."""
        plus, minus, _ = next(one for one in self.opamps if one[2] == out)
        to_plus, to_minus = list(self.at(plus)), list(self.at(minus))
        feedback = sum(g for n, g in to_minus if n == out)

        def evaluate(volts):
            level = 0.0
            if plus != "0":
                level = sum(g * volts[n] for n, g in to_plus) / sum(g for _, g in to_plus)
            return (level * sum(g for _, g in to_minus) - sum(g * volts[n] for n, g in to_minus if n != out)) / feedback

        return evaluate


def eliminated(rows):
    """Solution of a small complex system, rows [a | b]."""
    n = len(rows)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            if factor:
                rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k])]
    out = [0j] * n
    for k in reversed(range(n)):
        out[k] = (rows[k][n] - sum(rows[k][j] * out[j] for j in range(k + 1, n))) / rows[k][k]
    return out


def circuit(arguments, changed):
    run = Path(arguments.run)
    net = Netlist(run / "spice/compensator.sub", "compensator", changed)
    nodes = sorted({n for a, b, _ in net.passive.values() for n in (a, b)} - {"0", "in"})
    place = {node: i for i, node in enumerate(nodes)}
    opamp = re.search(r"gain-bandwidth (\S+) Hz, DC gain (\S+),", "\n".join(net.text))
    bandwidth, gain = float(opamp[1]), float(opamp[2].rstrip(","))
    noise = random.Random(7)
    rows = []
    low, high, count = arguments.from_hz, arguments.to_hz, 41
    for k in range(count):
        f = low * (high / low) ** (k / (count - 1))
        s = 2j * math.pi * f
        matrix = [[0j] * (len(nodes) + 1) for _ in nodes]
        for name, (a, b, value) in net.passive.items():
            y = 1.0 / value if name[0] == "R" else s * value
            for here, there in ((a, b), (b, a)):
                if here not in place:
                    continue
                row = matrix[place[here]]
                row[place[here]] += y
                if there in place:
                    row[place[there]] -= y
                elif there == "in":
                    row[-1] += y
        for plus, minus, out in net.opamps:  # V(out) (1/A0 + s/w) = V(plus) - V(minus), instead of the current there
            row = [0j] * (len(nodes) + 1)
            row[place[out]] += 1.0 / gain + s / (2.0 * math.pi * bandwidth)
            for node, sign in ((plus, -1.0), (minus, 1.0)):
                if node in place:
                    row[place[node]] += sign
                elif node == "in":
                    row[-1] -= sign
            matrix[place[out]] = row
        h = eliminated(matrix)[place["out"]]
        rows.append((f, 20.0 * math.log10(abs(h)) + noise.gauss(0.0, 0.001), math.degrees(cmath.phase(h)) + noise.gauss(0.0, 0.01)))
    write(arguments.output, ("frequency_hz", "magnitude_db", "phase_deg"), rows)


def controller(arguments, changed):
    run = Path(arguments.run)
    net = Netlist(run / "controller/controller.sub", "controller", changed)
    disturbance = json.loads((HERE.parent / "nanopositioner/disturbance.json").read_text())
    f = arguments.frequency_hz
    scale = 1.05
    # The slope meter: |dr/dt| = 2 f of a full-stroke triangle; then the rectifiers of the gain curve and the control voltages.
    volts = {"0": 0.0, **net.sources, "cd": 0.0, "ca": 0.0}
    if "Cw1" in net.passive:
        w0 = net.value("Rw2") * net.value("Cw1") * 2.0 * f
        half = w0 * net.value("Rw4") / net.value("Rw3")
        volts["sn"] = -net.value("Rw7") * (half / net.value("Rw6") - w0 / net.value("Rw5"))
        if "Rl1" in net.passive:
            volts["vl"] = volts["vr"] * net.value("Rl2") / (net.value("Rl1") + net.value("Rl2"))
        for name in sorted(n for n in net.passive if re.fullmatch(r"Rk\d+f", n)):
            m, k, feedback = net.passive[name]
            inward = sum(g * volts[n] for n, g in net.at(m) if n not in (k, m))
            volts[k] = -max(0.0, inward * feedback)
        for node in ("na", "ca", "nd", "cd"):
            if any(out == node for _, _, out in net.opamps):
                volts[node] = net.sum(node)(volts)
    # The closed contact is in series with the resistor behind it.
    contact = re.search(r"Gs a o VALUE=.*1e-10\+([0-9.e-]+)\*", "\n".join(net.text))
    a, b, value = net.passive["Rin"]
    net.passive["Rin"] = (a, b, value + 1.0 / float(contact[1]))
    last = net.sum("v")

    def reference_for(v, rising):
        """r for which the loop rests at v on a branch: the generator's voltages follow from v one after the other."""
        here = dict(volts, v=v)
        here["x2"] = v * v / scale
        here["x3"] = here["x2"] * v / scale
        out = "ba" if rising else "bd"
        here[out] = net.sum(out)(here)
        gained = "ga" if rising else "gd"
        if gained in net.multipliers:
            x, y, z = net.multipliers[gained]
            here[gained] = here[x] * here[y] / scale + here[z]
            out = gained
        here["sw"] = here[out]
        at_0, at_1 = last(dict(here, r=0.0)), last(dict(here, r=1.0))
        return (v - at_0) / (at_1 - at_0)

    grid = [-0.2 + 1.4 * i / 700 for i in range(701)]
    curve = {rising: [reference_for(v, rising) for v in grid] for rising in (True, False)}

    def drive(r, rising):
        table = curve[rising]
        low = bisect.bisect_right(table, r, 1, len(grid) - 1) - 1
        return grid[low] + (grid[low + 1] - grid[low]) * (r - table[low]) / (table[low + 1] - table[low])

    def rate(branch):
        table = disturbance.get("rate", {}).get(branch)
        if not table:
            return 1.0
        at = disturbance["rate"]["frequency_hz"]
        for a, b, ka, kb in zip(at, at[1:], table, table[1:]):
            if a <= f <= b:
                return ka + (kb - ka) * math.log(f / a) / math.log(b / a)
        return table[0] if f < at[0] else table[-1]

    gain = {True: rate("ascending"), False: rate("descending") * arguments.stage_falling}
    bend = arguments.stage_bend  # of the rising curve: + bend (x - 2 x^2 + x^3), which leaves both ends at zero
    shape = {True: [a + bend * b for a, b in zip(disturbance["ascending"], (1.0, -2.0, 1.0))], False: disturbance["descending"]}

    def bent(x, rising):
        a = shape[rising]
        return x + gain[rising] * x * (a[0] + x * (a[1] + x * a[2]))

    # amplifier, disturbance by the slope of the drive that arrives, damping compensator, resonance.
    corner = 2.0 * math.pi * arguments.amplifier_hz
    z1, z0, p1, p0 = 9.854e4, 1.67e11, 1.917e5, 1.436e11
    wn, zeta = 2.0 * math.pi * arguments.resonance_hz, 0.1206

    def slopes(state, v, rising):
        x, a, b, q, dq = state
        u = bent(x, (v > x) if abs(v - x) > 1e-12 else rising)
        made = 0.86 * (u + (z1 - p1) * b + (z0 - p0) * a)
        return (corner * (v - x), b, u - p1 * b - p0 * a, dq, wn * wn * (made - q) - 2.0 * zeta * wn * dq)

    period, periods, samples, inner = 1.0 / f, 3, 300, 64
    if f < 50.0:
        inner = int(inner * 50.0 / f)
    dt = period / samples / inner
    state = [0.0] * 5
    noise = random.Random(11)
    rows = []
    late = arguments.switch_late_s

    def switched(t):
        """The branch that the controller's switch stands on: from rest upwards, then so much behind each turn."""
        return t < late or (t - late) % period < 0.5 * period

    for k in range(periods * samples + 1):
        phase = k % samples / samples
        rising = phase < 0.5
        r = 2.0 * phase if rising else 2.0 - 2.0 * phase
        rows.append((k * period / samples, r, 6.92e-6 * (state[3] + noise.gauss(0.0, 2e-5))))
        step = (2.0 if rising else -2.0) / samples / inner
        for j in range(inner):
            branch = switched(k * period / samples + (j + 0.5) * dt)
            v0, v1, v2 = (drive(r + step * (j + part), branch) for part in (0.0, 0.5, 1.0))
            k1 = slopes(state, v0, rising)
            k2 = slopes([s + 0.5 * dt * d for s, d in zip(state, k1)], v1, rising)
            k3 = slopes([s + 0.5 * dt * d for s, d in zip(state, k2)], v1, rising)
            k4 = slopes([s + dt * d for s, d in zip(state, k3)], v2, rising)
            state = [s + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d) for s, a, b, c, d in zip(state, k1, k2, k3, k4)]
    write(arguments.output, ("time_s", "u", "y"), rows)


def write(path, names, rows):
    with open(path, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(names)
        table.writerows([f"{value:.9g}" for value in row] for row in rows)
    print(f"measured {len(rows)} rows into {path}")


def main():
    parser = argparse.ArgumentParser(prog="bench.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("circuit", "controller"))
    parser.add_argument("run", help="folder that bodesmith run wrote")
    parser.add_argument("parts", nargs="*", metavar="PART=FACTOR")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--amplifier-hz", type=float, default=100e3)
    parser.add_argument("--switch-late-s", type=float, default=0.0)
    parser.add_argument("--frequency-hz", type=float, default=100.0)
    parser.add_argument("--stage-falling", type=float, default=1.0, help="times the gain of its falling curve")
    parser.add_argument("--stage-bend", type=float, default=0.0, help="of its rising curve")
    parser.add_argument("--resonance-hz", type=float, default=65.1e3)
    parser.add_argument("--from-hz", type=float, default=0.1)
    parser.add_argument("--to-hz", type=float, default=10e3)
    arguments = parser.parse_intermixed_args()
    changed = {}
    for one in arguments.parts:
        name, _, factor = one.partition("=")
        changed[name] = float(factor)
    (circuit if arguments.what == "circuit" else controller)(arguments, changed)


if __name__ == "__main__":
    main()
