#!/usr/bin/env python3
"""Blind yardstick of `bodesmith diagnose`: effects hidden by simulators of its own.

Each case is a base model.toml, two training records of different speed and a held-out one (1000 to 2500 samples), all by the
equations below (NumPy alone; nothing of the program's). One or two effects of the catalogue are hidden, none (a control), or something
outside the catalogue. The effect's size is 4 to 60 times the noise (of what base's gain, bias and slow lag cannot take); noise is
white, red (20 to 200 samples) or 1/f.

    bench/hidden_effects.py --program build/bin/bodesmith --batch A --cases 60 --work DIR [--families]

`--families`: the families that were missed most (docs/gap.md) instead of the general draw. One line a case, then the counts.
"""
import argparse
import json
import math
import os
import random
import subprocess
import time

import numpy as np

FINE = 8  # steps inside a sample


# ---------------------------------------------------------------------------------------------- equations, on the fine grid
def lag(x, h, hz):
    a = 2 * math.pi * hz * h
    e = math.exp(-a)
    g = (1 - e) / a
    y = np.empty(len(x))
    s = 0.0
    y[0] = 0.0
    for i in range(1, len(x)):
        s = e * s + (g - e) * x[i - 1] + (1 - g) * x[i]
        y[i] = s
    return y


def resonator(x, h, hz, zeta, cubic=0.0, quadratic=0.0, drag=0.0, gain=1.0):
    w = 2 * math.pi * hz
    sub = max(1, int(math.ceil(w * h / 0.15)))
    k = h / sub
    y = np.empty(len(x))
    q, v = 0.0, 0.0
    y[0] = 0.0

    def acc(q, v, u):
        return gain * w * w * u - 2 * zeta * w * v - w * w * (q + quadratic * q * q + cubic * q**3) - drag * w * abs(v) * v

    for i in range(1, len(x)):
        a0, d = x[i - 1], (x[i] - x[i - 1]) / sub
        for j in range(sub):
            u0, u1 = a0 + d * j, a0 + d * (j + 1)
            um = 0.5 * (u0 + u1)
            k1q, k1v = v, acc(q, v, u0)
            k2q, k2v = v + k / 2 * k1v, acc(q + k / 2 * k1q, v + k / 2 * k1v, um)
            k3q, k3v = v + k / 2 * k2v, acc(q + k / 2 * k2q, v + k / 2 * k2v, um)
            k4q, k4v = v + k * k3v, acc(q + k * k3q, v + k * k3v, u1)
            q += k / 6 * (k1q + 2 * k2q + 2 * k3q + k4q)
            v += k / 6 * (k1v + 2 * k2v + 2 * k3v + k4v)
        y[i] = q
    return y


def delayed(x, h, seconds):
    t = np.arange(len(x)) * h
    return np.interp(t - seconds, t, x, left=x[0])


def play(x, radius):
    y = np.empty(len(x))
    s = 0.0
    for i, v in enumerate(x):
        s = max(v - radius, min(v + radius, s))
        y[i] = s
    return y


def plays(x, radii, weights):
    return sum(w * play(x, r) for r, w in zip(radii, weights))


def bouc_wen(x, amount, beta, gamma, half):
    y = np.empty(len(x))
    z = 0.0
    y[0] = x[0]
    b, g = beta / half, gamma * beta / half
    for i in range(1, len(x)):
        du = x[i] - x[i - 1]
        z += amount * du - b * abs(du) * z - g * du * abs(z)
        y[i] = x[i] - z
    return y


def slewed(x, h, rate):
    y = np.empty(len(x))
    s = x[0]
    y[0] = s
    for i in range(1, len(x)):
        s += max(-rate * h, min(rate * h, x[i] - s))
        y[i] = s
    return y


def slope_sign(x):
    d = np.sign(np.diff(x, prepend=x[0]))
    last = 1.0
    for i in range(len(d)):
        if d[i] == 0.0:
            d[i] = last
        last = d[i]
    return d


def branches(x, h, up, down, late_s=0.0):
    s = slope_sign(x)
    if late_s > 0.0:
        t = np.arange(len(x)) * h
        k = np.maximum(0, np.round((t - late_s) / h).astype(int))
        s = s[k]
        s[t < late_s] = 1.0
    a = x * (up[0] + x * (up[1] + x * up[2]))
    d = x * (down[0] + x * (down[1] + x * down[2]))
    return x + np.where(s > 0, a, d)


def held(x, h, clock_hz, half):
    t = np.arange(len(x)) * h
    edge = np.floor(t * clock_hz + 1e-9) / clock_hz
    y = np.interp(edge, t, x)
    return delayed(y, h, 0.5 / clock_hz) if half else y


def creeping(x, h, gains, taus):
    return x + sum(g * lag(x, h, 1 / (2 * math.pi * t)) for g, t in zip(gains, taus))


def fractional(x, h, lam, ratio, beta):
    """((lam s + 1)/(ratio lam s + 1))^beta by interlaced poles and zeros, six a decade."""
    lo, hi = 1 / (2 * math.pi * lam), 1 / (2 * math.pi * ratio * lam)
    n = max(3, int(6 * math.log10(hi / lo)))
    y = x
    for k in range(n):
        pole = lo * (hi / lo) ** ((k + 0.5 + 0.5 * beta) / n)
        zero = lo * (hi / lo) ** ((k + 0.5 - 0.5 * beta) / n)
        low = lag(y, h, pole)
        y = low + (pole / zero) * (y - low)
    return y


# ---------------------------------------------------------------------------------------------- drives
def drive(r, shape, n, step, low_hz, high_hz, size):
    t = np.arange(n) * step
    if shape == "multisine":
        k = r.randint(5, 12)
        u = sum(np.sin(2 * math.pi * low_hz * (high_hz / low_hz) ** (r.random()) * t + r.uniform(0, 6.28)) for _ in range(k))
        u = u * (1 - np.exp(-t * 3 * low_hz))
    elif shape == "sweep":
        rate = math.log(high_hz / low_hz) / t[-1]
        u = np.sin(2 * math.pi * low_hz * (np.exp(rate * t) - 1) / rate)
    elif shape == "triangles":
        f = math.sqrt(low_hz * high_hz) * 0.6
        c = (f * t) % 1
        u = np.where(c < .25, 4 * c, np.where(c < .75, 2 - 4 * c, 4 * c - 4)) * (1 - .75 * t / t[-1])
    elif shape == "two_tone":
        u = np.sin(2 * math.pi * low_hz * 1.3 * t) + .6 * np.sin(2 * math.pi * high_hz * .7 * t)
    elif shape == "noise":
        w = np.array([r.gauss(0, 1) for _ in range(n)])
        u = lag(lag(w, step, high_hz), step, high_hz)
    else:  # smooth steps
        edges = np.cumsum([r.uniform(.3, 1.5) / low_hz for _ in range(400)])
        levels = [r.uniform(-1, 1) for _ in range(401)]
        u = lag(np.array([levels[np.searchsorted(edges, v)] for v in t]), step, 2 * high_hz)
    u = u / np.max(np.abs(u)) * size
    return u - u[0]


def noise_of(r, kind, n, tau):
    g = np.array([r.gauss(0, 1) for _ in range(n)])
    if kind == "white":
        e = g
    elif kind == "red":
        rho = math.exp(-1 / tau)
        e = np.empty(n)
        s = r.gauss(0, 1)
        for i in range(n):
            s = rho * s + math.sqrt(1 - rho * rho) * g[i]
            e[i] = s
        e = e + .5 * np.array([r.gauss(0, 1) for _ in range(n)])
    else:
        f = np.fft.rfft(np.array([r.gauss(0, 1) for _ in range(2 * n)]))
        f[1:] /= np.sqrt(np.arange(1, len(f)))
        f[0] = 0
        e = np.fft.irfft(f)[:n]
    return e / math.sqrt(np.mean(e * e))


# ---------------------------------------------------------------------------------------------- bases: blocks in series
def block_text(kind, free, **values):
    def text(v):
        return "[" + ", ".join(f"{x:.9g}" for x in v) + "]" if isinstance(v, (list, tuple)) else f"{v:.9g}"

    lines = [f'[[block]]\ntype = "{kind}"'] + [f"{k} = {text(v)}" for k, v in values.items()]
    if free:
        lines.append("free = [" + ", ".join(f'"{k}"' for k in free) + "]")
    return "\n".join(lines) + "\n"


class Base:
    """Blocks as (text of the model.toml, function of (x, h)); the file's free values are some per cent off."""

    def __init__(self, r, name, band_hz):
        self.name = name
        self.blocks = []
        off = lambda v: v * math.exp(r.uniform(-.08, .08))
        g = r.uniform(.7, 1.4)
        self.gain = g
        self.resonator = None
        if name != "fixed_gain":
            self.blocks.append((block_text("gain", ["gain"], gain=off(g)), lambda x, h, o: g * x))
        else:
            self.blocks.append((block_text("gain", [], gain=g), lambda x, h, o: g * x))
        if name in ("pole", "chain"):
            c = band_hz * r.uniform(.8, 3)
            self.blocks.append((block_text("lowpass", ["corner_hz"], corner_hz=off(c)), lambda x, h, o, c=c: lag(x, h, c)))
        if name in ("resonator", "chain"):
            f, z = band_hz * r.uniform(.9, 2.2), r.uniform(.03, .3)
            self.resonator = len(self.blocks)
            self.blocks.append((block_text("resonator", ["natural_frequency_hz", "damping_ratio"], gain=1.0,
                                           natural_frequency_hz=off(f) if name == "chain" else f * math.exp(r.uniform(-.03, .03)), damping_ratio=off(z)),
                                lambda x, h, o, f=f, z=z: resonator(x, h, f, z, **o)))
        if name == "polynomial":
            up = [r.uniform(.05, .2), r.uniform(-.15, .15), r.uniform(-.1, .1)]
            down = [-r.uniform(.05, .2), r.uniform(-.15, .15), r.uniform(-.1, .1)]
            self.late = 0.0
            self.blocks.append((block_text("polynomial_hysteresis", [], ascending=up, descending=down),
                                lambda x, h, o: branches(x, h, up, down, self.late)))
        if name == "bank":
            radii = [.05, .15, .35, .7]
            weights = [r.uniform(.05, .3) for _ in radii]
            self.blocks.append((block_text("prandtl_ishlinskii", [], r=[0.0, *radii], w=[1.0, *weights]),
                                lambda x, h, o: x + plays(x, radii, weights)))

    def text(self):
        return 'schema = "bodesmith.model/1"\n' + "".join(t for t, _ in self.blocks)


BASES = ["gain", "fixed_gain", "pole", "resonator", "polynomial", "bank", "chain"]
ANY = ["offset", "drift", "mains_hum", "time_delay", "amplifier_pole", "resonance", "slew_limit", "saturation", "dead_zone", "backlash",
       "quadratic_nonlinearity", "cubic_nonlinearity", "hysteresis", "asymmetric_hysteresis", "creep", "rate_dependence", "sample_hold"]
OUTSIDE = ["kink", "echo", "gain_swings", "one_sided_lag", "butterfly", "burst", "exponential", "jump"]


def effect_of(r, kind, base, low_hz, high_hz, step, span, seconds):
    """(place, function of (x, h)): what comes in front of block number `place`; `amount` scales it."""
    n = len(base.blocks)
    # Of the first record alone: the system is one, whatever drives it.
    seen = {}
    largest = lambda x: seen.setdefault("largest", float(np.max(np.abs(x))))
    most = lambda x: seen.setdefault("most", float(np.max(x)))
    least = lambda x: seen.setdefault("least", float(np.min(x)))
    fastest = lambda x, h: seen.setdefault("fastest", float(np.max(np.abs(np.diff(x))) / h))
    memory = n if base.name not in ("polynomial", "bank") else r.choice([0, n])
    place = r.randint(0, n)
    b = math.sqrt(low_hz * high_hz)
    if kind == "offset":
        return n, lambda x, h, a: x + .3 * a * span
    if kind == "drift":
        return n, lambda x, h, a: x + .6 * a * span * np.arange(len(x)) * h / seconds
    if kind == "mains_hum":
        f = r.choice([50.0, 60.0, 100.0, 150.0]) * (1 + r.uniform(-.003, .003))
        return n, lambda x, h, a: x + .4 * a * span * np.sin(2 * math.pi * f * np.arange(len(x)) * h + 1)
    if kind == "time_delay":
        return place, lambda x, h, a: delayed(x, h, a * .15 / high_hz)
    if kind == "amplifier_pole":
        return place, lambda x, h, a: lag(x, h, high_hz / (.7 * a))
    if kind == "resonance":
        z = r.uniform(.02, .3)
        return place, lambda x, h, a: resonator(x, h, high_hz * (1.2 + .3 / a), z)
    if kind == "slew_limit":
        return place, lambda x, h, a: slewed(x, h, fastest(x, h) * (1 - min(.75, .6 * a)))
    if kind == "saturation":
        both = r.random() < .5
        return place, lambda x, h, a: np.clip(x, (least(x) * (1 - min(.7, .4 * a))) if both else -1e9, most(x) * (1 - min(.7, .4 * a)))
    if kind == "dead_zone":
        def zone(x, h, a):
            w = .15 * a * largest(x)
            return np.sign(x) * np.maximum(0, np.abs(x) - w)
        return place, zone
    if kind == "backlash":
        return memory, lambda x, h, a: play(x, .15 * a * largest(x))
    if kind == "quadratic_nonlinearity":
        return place, lambda x, h, a: x + .3 * a * x * x / largest(x)
    if kind == "cubic_nonlinearity":
        s = r.choice([-1, 1])
        return place, lambda x, h, a: x + s * .35 * a * x**3 / largest(x) ** 2
    if kind == "cubic_stiffness":
        return None, dict(cubic=.6 / span**2)
    if kind == "quadratic_stiffness":
        return None, dict(quadratic=.25 / span)
    if kind == "drag":
        return None, dict(drag=.8 / span)
    if kind == "hysteresis":
        if r.random() < .4:
            beta, gamma = r.uniform(1, 5), r.uniform(-.3, .6)
            return memory, lambda x, h, a: bouc_wen(x, .4 * min(a, 2), beta, gamma, largest(x))
        parts = sorted(r.uniform(.05, .7) for _ in range(4))
        w = [r.uniform(.1, .5) for _ in parts]
        return memory, lambda x, h, a: x + .4 * a * plays(x, [p * largest(x) for p in parts], w)
    if kind == "asymmetric_hysteresis":
        if r.random() < .5:
            up, down = [r.uniform(.1, .3), r.uniform(-.4, .4), r.uniform(-.3, .3)], [-r.uniform(.05, .3), r.uniform(-.4, .4), r.uniform(-.3, .3)]
            return memory, lambda x, h, a: branches(x, h, [.6 * a * v for v in up], [.6 * a * v for v in down])
        parts, w = [.1, .25, .5], [r.uniform(.1, .4) for _ in range(3)]
        s, v = r.uniform(-.2, .5), r.choice([-.4, .4, .5])
        def one_sided(x, h, a):
            m = largest(x)
            p = x + .5 * a * plays(x, [q * m for q in parts], w)
            return p + .6 * a * v * np.maximum(0, p - s * m)
        return memory, one_sided
    if kind == "creep":
        t0 = 1 / (2 * math.pi * low_hz)
        taus = [t0 * f for f in (1.5, 6, 24)]
        return place, lambda x, h, a: creeping(x, h, [.12 * a] * 3, taus)
    if kind == "rate_dependence":
        beta = r.choice([-1, 1]) * r.uniform(.1, .4)
        return place, lambda x, h, a: fractional(x, h, 1 / (2 * math.pi * low_hz * .5), low_hz / high_hz / 6, beta * min(1.0, .5 * a))
    if kind == "sample_hold":
        half = r.random() < .5
        clock = r.uniform(4, 12) * high_hz
        return place, lambda x, h, a: held(x, h, clock / min(2.5, max(.25, a)), half)
    if kind == "gain_error":
        return n, lambda x, h, a: x * (1 + .15 * a)
    # outside the catalogue
    if kind == "kink":
        return n, lambda x, h, a: x + .3 * a * np.abs(x - .3 * most(x)) + .2 * a * np.abs(x + .5 * most(x))
    if kind == "echo":
        return n, lambda x, h, a: x + .3 * a * delayed(x, h, 1.7 / high_hz)
    if kind == "gain_swings":
        return n, lambda x, h, a: x * (1 + .3 * a * np.sin(2 * math.pi * 3.3 / seconds * np.arange(len(x)) * h))
    if kind == "one_sided_lag":
        def sided(x, h, a):
            y = np.empty(len(x))
            s = y[0] = 0.0
            for i in range(1, len(x)):
                d = x[i] - s
                s += d * (1 - math.exp(-2 * math.pi * (high_hz * 8 if d > 0 else high_hz * 2 / a) * h))
                y[i] = s
            return y
        return n, sided
    if kind == "butterfly":
        return n, lambda x, h, a: x + .4 * a * np.abs(x - .5 * play(x, .4 * largest(x)))
    if kind == "burst":
        return n, lambda x, h, a: x + a * .3 * span * np.exp(-((np.arange(len(x)) / len(x) - .6) / .02) ** 2) * np.sin(2 * math.pi * 1.7 * high_hz * np.arange(len(x)) * h)
    if kind == "exponential":
        return n, lambda x, h, a: x + .5 * a * largest(x) * (np.exp(-3 * x / largest(x)) - 1) / 20
    if kind == "jump":
        return n, lambda x, h, a: x + .2 * a * span * (np.arange(len(x)) > .55 * len(x))
    raise ValueError(kind)


def run(base, hidden, u, step, amounts):
    x = np.interp(np.arange((len(u) - 1) * FINE + 1) / FINE, np.arange(len(u)), u)
    h = step / FINE
    inside = {}
    base.late = 0.0
    for (kind, place, f), a in zip(hidden, amounts):
        if kind == "switch_delay":
            base.late = f * a
        elif place is None:
            inside.update({k: v * a for k, v in f.items()})
    for k in range(len(base.blocks) + 1):
        for (kind, place, f), a in zip(hidden, amounts):
            if place == k and kind != "switch_delay" and a > 0:
                x = f(x, h, a)
        if k < len(base.blocks):
            x = base.blocks[k][1](x, h, inside)
    return x[::FINE]


def rest(d, *columns):
    """rms of d without what these columns explain."""
    m = np.stack(columns, 1)
    q, s, _ = np.linalg.svd(m, full_matrices=False)
    q = q[:, s > 1e-9 * s[0]]
    return math.sqrt(np.mean((d - q @ (q.T @ d)) ** 2))


def make_case(r, folder, kinds, base_name, noise_kind, times=None, samples=(1000, 2500)):
    """Writes the case's files; the truth as a dict."""
    n = r.randint(*samples)
    low = math.exp(r.uniform(math.log(1), math.log(8)))
    high = low * r.uniform(4, 12)
    step = 1 / (high * r.uniform(18, 40))
    speed = r.uniform(.25, .6)
    base = Base(r, base_name, high)
    shapes = ["multisine", "sweep", "triangles", "two_tone", "noise", "steps"]
    if base_name in ("polynomial", "bank") or any(k in ("hysteresis", "asymmetric_hysteresis", "backlash", "switch_delay") for k in kinds):
        shapes = ["multisine", "triangles", "two_tone", "sweep"]
    size = 1.0 if base_name in ("polynomial", "bank") else r.uniform(.5, 3)
    a_shape, b_shape = r.choice(shapes), r.choice(shapes)
    # The same step, another speed: frequencies are lower by `speed` in the second record.
    us = [drive(r, a_shape, n, step, low, high, size), drive(r, b_shape, n, step, low * speed, high * speed, size * r.uniform(.7, 1)),
          drive(r, r.choice(shapes), n, step, low * .8, high * .7, size * .8)]
    if base_name == "polynomial":  # its polynomials are meant for [0, 1]
        us = [.5 * (u + size) * .95 for u in us]
        us = [u - u[0] if u[0] > 0 else u for u in us]
        us = [(u - u.min()) / (u.max() - u.min()) * .95 for u in us]
        us = [np.concatenate([u[0] * np.linspace(0, 1, 60), u]) for u in us]
    ys0 = [run(base, [], u, step, []) for u in us]
    span = float(np.ptp(ys0[0]))
    hidden = []
    for kind in kinds:
        if kind == "switch_delay":
            hidden.append((kind, None, r.uniform(.03, .12) / high))
        else:
            place, f = effect_of(r, kind, base, low, high, step, span, n * step)
            hidden.append((kind, place, f))
    amounts = [math.exp(r.uniform(math.log(.4), math.log(1.6))) for _ in kinds]
    ys = [run(base, hidden, u, step, amounts) for u in us]
    sizes = []
    for k in range(len(kinds)):
        others = [a if j != k else 0.0 for j, a in enumerate(amounts)]
        without = [run(base, hidden, u, step, others) for u in us[:2]]
        left = []
        for y, w, u in zip(ys, without, us):
            absorbed = [w, np.ones(len(w)) * 1e-9]
            if base_name in ("pole", "chain", "resonator"):
                absorbed += [lag(w, step, high), np.gradient(w)]
            left.append(rest(y - w, *absorbed) if base_name != "fixed_gain" or kinds[k] != "gain_error" else math.sqrt(np.mean((y - w) ** 2)))
        sizes.append(math.sqrt(np.mean(np.square(left))))
    if sizes and min(sizes) <= 1e-6 * span:  # a limit that is never reached: nothing is hidden, draw again
        return make_case(r, folder, kinds, base_name, noise_kind, times, samples)
    times = times or math.exp(r.uniform(math.log(4), math.log(60)))
    sigma = min(sizes) / times if sizes else span * math.exp(r.uniform(math.log(3e-4), math.log(2e-2)))
    sigma = max(sigma, 1e-6 * span)
    tau = r.uniform(20, 200)
    os.makedirs(folder, exist_ok=True)
    with open(folder + "/model.toml", "w") as f:
        f.write(base.text())
    for name, u, y in zip("abh", us, ys):
        e = sigma * noise_of(r, noise_kind, len(u), tau)
        with open(f"{folder}/{name}.csv", "w") as f:
            f.write("time_s,u,y\n")
            f.writelines(f"{i * step:.12g},{p:.10g},{q:.10g}\n" for i, (p, q) in enumerate(zip(u, y + e)))
    truth = {"kinds": kinds, "base": base_name, "noise": noise_kind, "times": times, "sigma": sigma,
             "places": [p for _, p, _ in hidden], "sizes": [s / sigma for s in sizes], "shapes": [a_shape, b_shape], "span": span}
    with open(folder + "/truth.json", "w") as f:
        json.dump(truth, f)
    return truth


def suits(kind, base):
    if kind in ("cubic_stiffness", "quadratic_stiffness", "drag"):
        return base in ("resonator", "chain")
    if kind == "switch_delay":
        return base == "polynomial"
    if kind == "gain_error":
        return base == "fixed_gain"
    if kind in ("hysteresis", "asymmetric_hysteresis", "backlash"):
        return base not in ("polynomial", "bank") or kind == "backlash"
    return True


def plan(batch, cases):
    """Kinds, base, noise of each case of a batch: singles .5, pairs .22, controls .18, outsiders .1."""
    r = random.Random(f"plan {batch}")
    every = ANY + ["cubic_stiffness", "quadratic_stiffness", "drag", "switch_delay", "gain_error"]
    singles = every[:]
    r.shuffle(singles)
    out = []
    for i in range(cases):
        noise = r.choice(["white", "white", "red", "pink"])
        what = (i % 50) / 50
        if what < .5:
            kind = singles[i % len(singles)] if singles else r.choice(every)
            kinds = [kind]
            base = r.choice([b for b in BASES if suits(kind, b)])
        elif what < .72:
            base = r.choice(BASES)
            kinds = r.sample([k for k in every if suits(k, base)], 2)
        elif what < .9:
            kinds, base = [], r.choice(BASES)
        else:
            kinds, base = [r.choice(OUTSIDE)], r.choice(["gain", "pole", "resonator"])
        out.append((kinds, base, noise, None))
    return out


def family_plan(batch, cases):
    r = random.Random(f"families {batch}")
    kinds = [(["switch_delay"], "polynomial"), (["sample_hold"], "pole"), (["asymmetric_hysteresis"], "gain"), (["backlash"], "bank"), (["creep"], "resonator"),
             (["slew_limit"], "chain"), (["resonance"], "gain"), (["hysteresis", "time_delay"], "gain"), (["hysteresis"], "fixed_gain"), (["switch_delay", "time_delay"], "polynomial"),
             (["creep"], "gain"), (["time_delay"], "bank")]
    return [(*kinds[i % len(kinds)], r.choice(["white", "red", "white"]), r.uniform(5, 30)) for i in range(cases)]


def judged(truth, d):
    named = [s["effect"] for s in d["steps"]]
    tied = [set(s["tied_with"]) | {s["effect"]} for s in d["steps"]]
    kinds = truth["kinds"]
    out = {"named": named, "tied": [sorted(t - {s}) for t, s in zip(tied, named)], "verdict": d["verdict"],
           "probability": [round(s.get("probability", 0), 3) for s in d["steps"]], "outside": round(d.get("outside", 0), 3),
           "alternatives": d.get("alternatives", [])[:4]}
    if not kinds:
        out["ok"] = not named
        return out
    if kinds[0] in OUTSIDE:
        out["ok"] = d["verdict"] in ("unexplained", "partly_explained")
        return out
    out["each"] = [1.0 if k in named else .7 if any(k in t for t in tied) else 0.0 for k in kinds]
    out["extra"] = max(0, len(named) - len(kinds)) if all(out["each"]) else len([k for k in named if k not in kinds])
    out["outright"] = sorted(named) == sorted(kinds)
    out["ok"] = all(out["each"]) and out["extra"] == 0
    left = d["gap"]["final"]["holdout_rms"]
    first = d["gap"]["refitted"]["holdout_rms"]
    noise = truth["sigma"] ** 2
    gap2 = first * first - noise
    out["closure"] = 1 - math.sqrt(max(0.0, left * left - noise) / gap2) if gap2 > noise else None
    return out


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--program", required=True)
    p.add_argument("--batch", default="dev")
    p.add_argument("--cases", type=int, default=50)
    p.add_argument("--first", type=int, default=0)
    p.add_argument("--families", action="store_true")
    p.add_argument("--threads", default="1")
    p.add_argument("--work", required=True)
    p.add_argument("--tag", default="", help="of the results, beside the cases that are made once")
    p.add_argument("--only", default="", help="cases whose line contains this")
    p.add_argument("--quiet", action="store_true")
    args = p.parse_args()
    cases = (family_plan if args.families else plan)(args.batch, args.first + args.cases)
    rows = []
    results = open(f"{args.work}/{args.batch}{'-families' if args.families else ''}-{args.tag or 'run'}.jsonl", "a") if os.path.isdir(args.work) else None
    if results is None:
        os.makedirs(args.work)
        results = open(f"{args.work}/{args.batch}{'-families' if args.families else ''}-{args.tag or 'run'}.jsonl", "a")
    for i, (kinds, base, noise, times) in enumerate(cases):
        if i < args.first:
            continue
        name = "+".join(kinds) or "control"
        if args.only and args.only not in f"{i} {name} {base} {noise}":
            continue
        folder = f"{args.work}/{args.batch}{'-families' if args.families else ''}/{i:03}"
        if not os.path.exists(folder + "/truth.json"):
            make_case(random.Random(f"{args.batch} {args.families} {i}"), folder, kinds, base, noise, times)
        truth = json.load(open(folder + "/truth.json"))
        out = f"{folder}/out{args.tag}"
        begun = time.time()
        t0 = os.times()
        code = subprocess.run([args.program, "diagnose", folder + "/model.toml", "--data", folder + "/a.csv", folder + "/b.csv", "--holdout",
                               folder + "/h.csv", "-o", out, "--threads", args.threads], capture_output=True, text=True)
        t1 = os.times()
        if code.returncode != 0:
            print(i, name, base, "FAILED", code.stderr[-300:])
            continue
        d = json.load(open(out + "/diagnosis.json"))
        row = judged(truth, d)
        row.update(case=i, truth=truth, cpu_s=t1.children_user - t0.children_user, wall_s=time.time() - begun)
        rows.append(row)
        results.write(json.dumps(row) + "\n")
        results.flush()
        if not args.quiet:
            said = ", ".join(n + ("|" + "|".join(t) if t else "") for n, t in zip(row["named"], row["tied"])) or "-"
            print(f"{i:3} {'ok ' if row['ok'] else 'BAD'} {name:38} {base:10} {noise:5} x{truth['times'] if kinds else 0:5.1f} {row['verdict']:16} {said} "
                  f"p{row['probability']} {row['cpu_s']:.1f}s", flush=True)
    report(rows)


def report(rows):
    effects = [r for r in rows if r["truth"]["kinds"] and r["truth"]["kinds"][0] not in OUTSIDE]
    singles = [r for r in effects if len(r["truth"]["kinds"]) == 1]
    pairs = [r for r in effects if len(r["truth"]["kinds"]) == 2]
    controls = [r for r in rows if not r["truth"]["kinds"]]
    outside = [r for r in rows if r["truth"]["kinds"] and r["truth"]["kinds"][0] in OUTSIDE]
    each = lambda rs: sum(sum(r["each"]) for r in rs) / max(1, sum(len(r["each"]) for r in rs))
    share = lambda rs, f: f"{sum(1 for r in rs if f(r))} of {len(rs)}"
    print(f"singles named {each(singles):.3f}, outright {share(singles, lambda r: r['outright'])}; pairs' effects named {each(pairs):.3f}, outright "
          f"{share(pairs, lambda r: r['outright'])}; no extra name {share(effects, lambda r: r['extra'] == 0)}")
    print(f"all effects named {each(effects):.3f} of {sum(len(r['each']) for r in effects)}; at five times the noise and more "
          f"{each([r for r in effects if r['truth']['times'] >= 5]):.3f}")
    print(f"false alarms {share(controls, lambda r: bool(r['named']))}, nothing_missing {share(controls, lambda r: r['verdict'] == 'nothing_missing')}; outsiders told "
          f"{share(outside, lambda r: r['ok'])}")
    closures = sorted(r["closure"] for r in effects if r.get("closure") is not None)
    times = sorted(r["cpu_s"] for r in rows)
    if closures and times:
        print(f"closure median {closures[len(closures) // 2]:.3f}; cpu median {times[len(times) // 2]:.1f} s, longest {times[-1]:.1f} s")


if __name__ == "__main__":
    main()
