"""A third generator of hidden effects, written from the contract alone: how a precision-motion or an analog bench measures.

Rasters with flyback, staircases, chirps, ramps with pauses, sines of several amplitudes, odd multisines, filtered random and telegraph
drives; volts in and volts, micrometres or nanometres out; 200 Hz to 200 kHz, 600 to 2500 samples, two or three training records and a
held-out one. The base is a chain of one to three blocks. Hidden are one or two effects of the catalogue, nothing, or something outside
it. Noise is white, of a converter's steps, red, 1/f, or white with a little hum. An effect's size is the rms of what it adds to the
training records once the base's free values (linearised) and the other effect's amount have taken what they can, over the noise's rms.
"""
import math
import os

import numpy as np

FINE = 8  # steps inside a sample


# ------------------------------------------------------------------------------------ equations, on the fine grid, at rest before t = 0
def lag(x, h, hz):
    """First-order lag, exact for an input that is straight between the steps."""
    a = 2 * math.pi * hz * h
    e = math.exp(-a)
    g = -math.expm1(-a) / a
    y, s, last = [], 0.0, x[0]
    for v in x.tolist():
        s = e * s + (g - e) * last + (1 - g) * v
        last = v
        y.append(s)
    return np.array(y)


def mode(x, h, hz, zeta, quadratic=0.0, cubic=0.0, drag=0.0):
    """q'' + 2 zeta w q' + drag w |q'| q' + w^2 (q + quadratic q^2 + cubic q^3) = w^2 x by Runge and Kutta: q and q'/w."""
    w = 2 * math.pi * hz
    k, q, p, d = w * h, 0.0, 0.0, drag * w
    force = lambda q, p, u: u - q * (1 + q * (quadratic + cubic * q)) - p * (2 * zeta + d * abs(p))
    out, last = [(0.0, 0.0)], x[0]
    for u in x[1:].tolist():
        a, half = force(q, p, last), 0.5 * (last + u)
        q1, p1 = q + k / 2 * p, p + k / 2 * a
        b = force(q1, p1, half)
        q2, p2 = q + k / 2 * p1, p + k / 2 * b
        c = force(q2, p2, half)
        q3, p3 = q + k * p2, p + k * c
        q, p = q + k / 6 * (p + 2 * p1 + 2 * p2 + p3), p + k / 6 * (a + 2 * b + 2 * c + force(q3, p3, u))
        if not abs(q) < 1e9:
            raise ArithmeticError("the spring gave way")
        last = u
        out.append((q, p))
    return np.array(out).T


def late(x, h, seconds):
    t = np.arange(len(x)) * h
    return np.interp(t - seconds, t, x, left=0.0)


def stepwise(items, follow, s=0.0):
    """s, then what each item makes of it."""
    out = []
    for item in items:
        s = follow(s, item)
        out.append(s)
    return np.array(out)


def play(x, radius, jump=False):
    """Play of half width `radius`; with `jump` it sticks and then slips all the way."""
    return stepwise(x.tolist(), lambda s, v: s if abs(v - s) <= radius else v if jump else v - math.copysign(radius, v - s))


def duhem(x, up, down, slope):
    """Coleman and Hodgdon: dz = rate |dx| (slope x - z) with another rate each way: what lags behind the line slope x."""
    moves = zip(x.tolist(), np.diff(x, prepend=x[0]).tolist())
    return stepwise(moves, lambda z, m: z - math.expm1(-abs(m[1]) * (up if m[1] > 0 else down)) * (slope * m[0] - z))


def dahl(x, stiffness, power, skew=0.0):
    """Friction after Dahl: dF = stiffness dx (1 - F sign dx)^power (1 + skew sign dx)."""
    def follow(f, d):
        s = math.copysign(1.0, d)
        return max(-1.0, min(1.0, f + stiffness * d * max(1 - f * s, 0.0) ** power * (1 + skew * s)))
    return stepwise(np.diff(x, prepend=x[0]).tolist(), follow)


def rising(x, late_steps=0):
    s = np.sign(np.diff(x, prepend=x[0]))
    seen = np.maximum.accumulate(np.where(s != 0, np.arange(len(s)), 0))
    s = s[seen]
    return np.concatenate([np.ones(late_steps), s])[:len(x)] >= 0


def cubic(x, c):
    return x * (c[0] + x * (c[1] + x * c[2]))


def convolved(x, kernel):
    n = 2 * len(x)
    return np.fft.irfft(np.fft.rfft(x, n) * np.fft.rfft(kernel, n), n)[:len(x)]


def through(x, h, response):
    """A response given on the imaginary axis; the drive comes back to zero behind the record, long before it starts again."""
    n = len(x)
    padded = np.concatenate([x, x[-1] * np.linspace(1, 0, n), np.zeros(6 * n)])
    return np.fft.irfft(np.fft.rfft(padded) * response(2j * np.pi * np.fft.rfftfreq(8 * n, h)), 8 * n)[:n]


# ------------------------------------------------------------------------------------ drives and noise
def drive(r, shape, n, rate, hz):
    t = np.arange(n) / rate
    c, cycle = (hz * t) % 1, (hz * t).astype(int)
    sizes = r.uniform(.35, 1, n)[cycle]
    if shape == "raster":  # trace, then a quick flyback
        u = np.where(c < .88, c / .88, .5 + .5 * np.cos(np.pi * (c - .88) / .12))
    elif shape == "staircase":
        stairs = int(r.integers(4, 9))
        x = 2 * stairs * c
        u = (np.minimum(x, 2 * stairs - x).clip(0)) // 1 / stairs
        u = np.convolve(np.concatenate([np.zeros(4), u]), np.ones(5) / 5, "valid")
    elif shape == "chirp":
        u = np.sin(2 * np.pi * hz * (.3 * t + 1.2 * t * t / t[-1]))
    elif shape == "pauses":
        u = np.interp(c, [0, .3, .5, .8, 1], [0, 1, 1, 0, 0]) * sizes
    elif shape == "amplitudes":
        u = np.sin(2 * np.pi * hz * t) * sizes
    elif shape == "multisine":
        u = sum(np.sin(2 * np.pi * hz * k * t - np.pi * k * k / 24 + r.uniform(0, 1)) for k in (1, 3, 5, 9, 11))
    elif shape == "random":
        u = lag(lag(r.standard_normal(n), 1 / rate, 2 * hz), 1 / rate, 2 * hz)
    else:  # telegraph
        u = lag(lag(r.choice([-1.0, 1.0], n)[(2.3 * hz * t).astype(int)], 1 / rate, 5 * hz), 1 / rate, 9 * hz)
    return u / np.max(np.abs(u))


SHAPES = ["raster", "staircase", "chirp", "pauses", "amplitudes", "multisine", "random", "telegraph"]


def noise(r, kind, y, sigma, rate):
    """y with noise of this rms."""
    n, e = len(y), r.standard_normal(len(y))
    if kind == "converter":
        step = sigma * r.uniform(.7, 3)
        return np.round((y + e * math.sqrt(sigma**2 - step**2 / 12)) / step) * step
    if kind in ("red", "flicker"):
        f = np.fft.rfftfreq(4 * n)
        f[0] = f[1]
        e = np.fft.irfft(np.fft.rfft(r.standard_normal(4 * n)) / (np.hypot(1, f * 60) if kind == "red" else np.sqrt(f)), 4 * n)[:n]
        e = e / np.std(e)
    if kind == "hum":
        e = .9 * e + .6 * np.sin(2 * np.pi * 50 * np.arange(n) / rate + r.uniform(0, 6))
    return y + sigma * e


# ------------------------------------------------------------------------------------ bases
def section(x, h, v):
    q, p = mode(x, h, v["natural_frequency_hz"], v["damping_ratio"])
    return v["lowpass_gain"] * q + v["bandpass_gain"] * p + v["highpass_gain"] * (x - q - 2 * v["damping_ratio"] * p)


def pole_zero(x, h, v):
    ratio = v["pole_hz"] / v["zero_hz"]
    return v["gain"] * (ratio * x + (1 - ratio) * lag(x, h, v["pole_hz"]))


RUN = {"gain": lambda x, h, v, _: v["gain"] * x, "lowpass": lambda x, h, v, _: lag(x, h, v["corner_hz"]),
       "resonator": lambda x, h, v, inside: v["gain"] * mode(x, h, v["natural_frequency_hz"], v["damping_ratio"], *inside.get("spring", ()))[0],
       "creep": lambda x, h, v, _: x + sum(g * lag(x, h, 1 / (2 * np.pi * t)) for g, t in zip(v["gains"], v["time_constants_s"])),
       "pole_zero": lambda x, h, v, _: pole_zero(x, h, v), "biquad": lambda x, h, v, _: section(x, h, v),
       "prandtl_ishlinskii": lambda x, h, v, _: sum(w * play(x, s) for s, w in zip(v["r"], v["w"])),
       "polynomial_hysteresis": lambda x, h, v, inside: x + np.where(rising(x, int(inside.get("late", 0) / h)), cubic(x, v["ascending"]), cubic(x, v["descending"]))}
BASES = {"amplifier": ["gain", "lowpass"], "scanner": ["gain", "resonator"], "sensed scanner": ["gain", "resonator", "lowpass"], "slow stage": ["gain", "creep"],
         "slow scanner": ["creep", "gain", "resonator"], "lead": ["gain", "pole_zero"], "cascade": ["pole_zero", "pole_zero", "gain"], "filter": ["biquad", "gain"],
         "piezo": ["prandtl_ishlinskii", "gain"], "piezo scanner": ["prandtl_ishlinskii", "gain", "lowpass"], "two poles": ["gain", "lowpass", "lowpass"],
         "branches": ["gain", "polynomial_hysteresis", "gain"], "wire": ["gain"]}


def block(r, kind, hz, rate, stroke, gain, seconds):
    """Values, and which of them may be free."""
    within = lambda low, high: float(np.exp(r.uniform(np.log(low), np.log(max(high, 1.2 * low)))))
    if kind == "gain":
        return {"gain": gain}, ["gain"]
    if kind == "lowpass":
        return {"corner_hz": within(3 * hz, rate / 8)}, ["corner_hz"]
    if kind == "resonator":
        return {"gain": 1.0, "natural_frequency_hz": within(4 * hz, rate / 12), "damping_ratio": within(.01, .4)}, ["natural_frequency_hz", "damping_ratio"]
    if kind == "creep":
        return {"gains": list(r.uniform(.02, .07, 2)), "time_constants_s": [seconds * r.uniform(.03, .1), seconds * r.uniform(.3, 1.5)]}, []
    if kind == "pole_zero":
        corner = within(2 * hz, rate / 15)
        return {"gain": 1.0, "zero_hz": corner, "pole_hz": corner * r.choice([.5, .7, 1.5, 2.5])}, []
    if kind == "biquad":
        return {"lowpass_gain": 1.0, "bandpass_gain": r.uniform(0, .5), "highpass_gain": r.choice([0.0, 1.0]), "natural_frequency_hz": within(3 * hz, rate / 15),
                "damping_ratio": r.uniform(.3, .9)}, []
    if kind == "prandtl_ishlinskii":
        return {"r": [0.0, *(stroke * np.array([.04, .12, .25, .45]))], "w": [1.0, *r.uniform(.05, .2, 4)]}, []
    return {"ascending": [r.uniform(.1, .3), -r.uniform(.1, .4), r.uniform(-.1, .1)], "descending": [-r.uniform(.05, .2), r.uniform(0, .2), r.uniform(-.1, .1)]}, []


# ------------------------------------------------------------------------------------ what is hidden: x, step, record -> y
SMOOTH = ("lowpass", "resonator")  # nothing of their input comes out at once
BEHIND = ("offset", "drift", "mains_hum", "gain_error")
SPRING = ("quadratic_stiffness", "cubic_stiffness", "drag")
OUTSIDE = ["delay_each_way", "stick_slip", "gain_of_rate", "warming", "lost_samples", "glitches", "vibration", "one_sided_lag", "echo", "knee", "coarse_converter"]
EFFECTS = ["offset", "drift", "mains_hum", "time_delay", "amplifier_pole", "resonance", "slew_limit", "saturation", "dead_zone", "backlash",
           "quadratic_nonlinearity", "cubic_nonlinearity", *SPRING, "hysteresis", "asymmetric_hysteresis", "rate_dependence", "creep", "gain_error",
           "switch_delay", "capacitor_mismatch", "sample_hold"]
ALIKE = [{"offset", "drift", "creep", "rate_dependence"}, {"time_delay", "amplifier_pole", "resonance", "sample_hold", "slew_limit", "rate_dependence", "switch_delay", "capacitor_mismatch"},
         {"backlash", "hysteresis", "asymmetric_hysteresis", "dead_zone", "creep"},
         {"saturation", "dead_zone", "quadratic_nonlinearity", "cubic_nonlinearity", "cubic_stiffness", "quadratic_stiffness", "asymmetric_hysteresis"}]


def suits(kind, kinds):
    if kind in SPRING:
        return "resonator" in kinds
    if kind == "switch_delay":
        return "polynomial_hysteresis" in kinds
    if kind == "capacitor_mismatch":
        return "pole_zero" in kinds or "biquad" in kinds
    return not (kind in ("hysteresis", "asymmetric_hysteresis", "backlash") and ("prandtl_ishlinskii" in kinds or "polynomial_hysteresis" in kinds))


def effect(r, kind, x, rate, hz, seconds, unipolar, direct):
    """x: what passes at its place in the first training record."""
    top, low, most = float(x.max()), float(x.min()), float(np.abs(x).max())
    fast = float(np.abs(np.diff(x)).max() * rate * FINE)
    q, sign, time = r.uniform, r.choice([-1, 1]), lambda x, h: np.arange(len(x)) * h
    if kind == "offset":
        c = sign * q(.01, .1) * most
        return lambda x, h, i: x + c
    if kind == "drift":
        c = sign * q(.02, .2) * most / seconds
        return lambda x, h, i: x + c * time(x, h)
    if kind == "mains_hum":
        f, c, phase = r.choice([50, 60, 100, 120, 150, 180]) * q(.997, 1.003), q(.005, .08) * most, q(0, 6, 4)
        seen = abs(f - rate * round(f / rate))
        return None if min(seen, rate / 2 - seen) * seconds < 4 else lambda x, h, i: x + c * np.sin(2 * np.pi * f * time(x, h) + phase[i])
    if kind == "time_delay":
        s = q(.4, 5) / rate
        return lambda x, h, i: late(x, h, s)
    if kind == "amplifier_pole":
        f = rate / q(6, 50)
        return lambda x, h, i: lag(x, h, f)
    if kind == "resonance":
        f, z, share = rate / q(6, 25), math.exp(q(math.log(.01), math.log(.4))), sign * q(.05, .4)
        if q() < .6:
            return lambda x, h, i: mode(x, h, f, z)[0]
        return lambda x, h, i: x + share * mode(x, h, f, z)[0]
    if kind == "slew_limit":
        step = q(.3, .85) * fast
        return lambda x, h, i: stepwise(x.tolist(), lambda s, v: s + max(-step * h, min(step * h, v - s)))
    if kind == "saturation":
        a, b = (q(.6, .93) * top, q(.6, .93) * low) if q() < .5 or low > -.3 * top else (q(.6, .93) * top, 10 * low)
        return lambda x, h, i: np.clip(x, b if low < -.3 * top else -10 * most, a)
    if kind == "dead_zone":
        w = q(.01, .12) * most
        return lambda x, h, i: x - np.clip(x, -w, w)
    if kind == "backlash":
        w = q(.01, .12) * most
        return lambda x, h, i: play(x, w)
    if kind == "quadratic_nonlinearity":
        c = sign * q(.03, .25) / most
        return r.choice([lambda x, h, i: x + c * x * x, lambda x, h, i: x + 2 * c * most**2 * (np.cosh(x / most) - 1)])
    if kind == "cubic_nonlinearity":
        c = q(.1, .3)
        return r.choice([lambda x, h, i: x + sign * c * x**3 / most**2, lambda x, h, i: most / (2 * c) * np.tanh(2 * c * x / most),
                         lambda x, h, i: most / (3 * c) * np.sinh(3 * c * x / most)])
    if kind == "hysteresis":
        a, b = q(1, 6) / most, q(.05, .25)
        return r.choice([lambda x, h, i: x - duhem(x, a, a, -b), lambda x, h, i: x - b * most * dahl(x, a, 1.0), lambda x, h, i: x - b * most * dahl(x, a, 2.0),
                         lambda x, h, i: x + b * sum(play(x, p * most) for p in (.07, .2, .45))])
    if kind == "asymmetric_hysteresis":
        a, b, skew = q(1, 6) / most, q(.05, .25), sign * q(.25, .6)
        if unipolar and q() < .5:  # the branches of examples/nanopositioner/disturbance.json
            up, down = [q(.05, .3), -q(.1, .4), q(-.1, .1)], [-q(.05, .2), q(0, .2), q(-.1, .1)]
            return lambda x, h, i: x + most * np.where(rising(x), cubic(x / most, up), cubic(x / most, down))
        return r.choice([lambda x, h, i: x + duhem(x, a * (1 + skew), a * (1 - skew), b), lambda x, h, i: x - b * most * dahl(x, a, 1.0, skew)])
    if kind == "rate_dependence":
        lead, a, b = sign * q(.03, .25), 2 * np.pi * hz * q(.1, .5), 2 * np.pi * hz * q(8, 30)
        return lambda x, h, i: through(x, h, lambda s: ((1 + s / a) / (1 + s / b)) ** lead)
    if kind == "creep":  # x (1 + c ln(1 + t/t0)) for a step
        c, t0, taus, b = q(.01, .06), seconds * q(.003, .03), seconds * np.array([q(.03, .1), q(.3, 1)]), q(.02, .1)
        relaxed = lambda x, h, i: x + convolved(x, c * h / (t0 + time(x, h)))
        return r.choice([relaxed, lambda x, h, i: x + b * sum(lag(x, h, 1 / (2 * np.pi * t)) for t in taus)])
    if kind == "gain_error":
        c = 1 + sign * q(.01, .12)
        return lambda x, h, i: c * x
    if kind == "sample_hold":  # every `steps` fine steps; at an edge smooth blocks are given the mean, which their straight steps integrate rightly
        steps = int(round(FINE * q(2.5, 9)))

        def held(x, h, _):
            y = x[np.arange(len(x)) // steps * steps]
            return y if direct else .5 * (y + np.concatenate([y[:1], y[:-1]]))
        return held
    a, b, at = q(.05, .3), q(.2, 1) / rate, q(.3, .7)  # from here on outside the catalogue
    if kind == "delay_each_way":
        return lambda x, h, i: np.where(rising(x), late(x, h, 2 * b), late(x, h, 8 * b))
    if kind == "stick_slip":
        return lambda x, h, i: play(x, .2 * a * most, True)
    if kind == "gain_of_rate":
        return lambda x, h, i: x * (1 + a * (np.abs(np.gradient(x, h)) / fast))
    if kind == "warming":
        return lambda x, h, i: x * (1 - a * -np.expm1(-time(x, h) / seconds / at))
    if kind == "lost_samples":
        return lambda x, h, i: x[np.arange(len(x)) - np.where(np.arange(len(x)) >= at * len(x), int(40 * a) * FINE, 0)]
    if kind == "glitches":
        where = np.sort(r.uniform(.05, .95, 6))
        return lambda x, h, i: x + a * most * sum(np.exp(-np.clip(time(x, h) - w * seconds, 0, None) * rate / 3) * (time(x, h) >= w * seconds) for w in (where + .1 * i) % 1)
    if kind == "vibration":
        f = hz * q(2.2, 7)
        return lambda x, h, i: x + .3 * a * most * np.sin(2 * np.pi * f * time(x, h) + i) * (1 + .5 * np.sin(2 * np.pi * f * .07 * time(x, h)))
    if kind == "one_sided_lag":
        return lambda x, h, i: stepwise(x.tolist(), lambda s, v: s - (v - s) * math.expm1(-h * rate / (1.2 if v > s else 4 + 40 * a)))
    if kind == "echo":
        return lambda x, h, i: x + a * late(x, h, (25 + 60 * at) / rate)
    if kind == "knee":
        return lambda x, h, i: x - a * np.clip(x - at * top, 0, None) - a * np.clip(x - .5 * at * top, 0, None) * 1.5
    return lambda x, h, i: np.round(x / (a * .2 * most)) * a * .2 * most  # coarse_converter


def simulated(blocks, values, hidden, u, rate, record, active, nodes=None):
    n = len(u)
    x, h = np.interp(np.arange((n - 1) * FINE + 1) / FINE, np.arange(n), u), 1 / rate / FINE
    for k in range(len(blocks) + 1):
        for j, (place, f) in enumerate(hidden):
            if place == k and callable(f) and active[j]:
                x = f(x, h, record)
        if nodes is not None:
            nodes.append(x)
        if k < len(blocks):
            inside, now = {}, dict(values[k])
            for j, (place, f) in enumerate(hidden):
                if place == k and isinstance(f, dict) and active[j]:
                    inside.update({key: tuple(np.add(f["spring"], inside.get("spring", (0, 0, 0)))) if key == "spring" else v for key, v in f.items()})
                    now.update({key: now[key] * v for key, v in f.get("ratios", {}).items()})
            x = RUN[blocks[k]](x, h, now, inside)
    return x[::FINE]


def make_case(seed, folder):
    """Writes model.toml, a.csv, b.csv, perhaps c.csv (training) and h.csv (held out); what is hidden."""
    r = np.random.default_rng(seed)
    try:
        case = drawn(r, folder, f"{seed}")
    except ArithmeticError:
        case = None
    return case or make_case([*np.atleast_1d(seed), 1], folder)


def drawn(r, folder, name):
    rate, n, count = float(f"{math.exp(r.uniform(math.log(200), math.log(2e5))):.2g}"), int(r.integers(600, 2500)), int(r.choice([2, 3]))
    hz = r.uniform(4, min(20, n / 60)) * rate / n
    base = str(r.choice(list(BASES)))
    blocks, seconds = BASES[base], n / rate
    what = r.choice(["single", "pair", "control", "outside"], p=[.5, .2, .15, .15])
    fit = [e for e in EFFECTS if suits(e, blocks)]
    kinds = [str(r.choice(fit))] if what in ("single", "pair") else [str(r.choice(OUTSIDE))] if what == "outside" else []
    if what == "pair":
        kinds.append(str(r.choice([e for e in fit if not any(kinds[0] in g and e in g for g in ALIKE) and e != kinds[0]])))
    unipolar = base in ("branches",) or r.random() < .3
    stroke, gain = (float(r.choice([10, 60, 100, 150])), float(r.choice([.07, 70.0, .2]))) if unipolar or "piezo" in base else (float(r.choice([.05, 1, 2.5, 10])), r.uniform(.3, 8))
    drawn_blocks = [block(r, k, hz, rate, stroke, gain, seconds) for k in blocks]
    if base == "branches":
        drawn_blocks[0] = ({"gain": 1 / stroke}, [])
        drawn_blocks[2] = ({"gain": gain * stroke}, ["gain"])
    fixed = "gain_error" in kinds or "capacitor_mismatch" in kinds
    values, free = [v for v, _ in drawn_blocks], [[] if fixed and f == ["gain"] else f for _, f in drawn_blocks]
    shapes, inputs = r.permutation(SHAPES), []
    for i, (f, size) in enumerate([(hz, 1), (hz * r.uniform(.35, .7), r.uniform(.5, 1)), (hz * r.uniform(1.2, 1.8), r.uniform(.6, 1)), (hz * r.uniform(.6, 1.2), r.uniform(.6, .95))]):
        u = drive(r, shapes[i], n, rate, f)
        if unipolar:
            low = u.min()
            u = (u - low) / (u.max() - low) * np.minimum(1, np.arange(n) / rate * 3 * f)
        inputs.append(stroke * size * (u - u[0]))
    inputs = inputs[:count] + inputs[3:]
    nodes = []
    simulated(blocks, values, [], inputs[0], rate, 0, [], nodes)
    hidden = []
    for kind in list(kinds):
        if kind in SPRING:
            k = blocks.index("resonator")
            y = nodes[k + 1]
            c, most = r.uniform(.03, .4), float(np.abs(y).max())
            slope = float(np.abs(np.diff(y)).max() * rate * FINE)
            spring = {"quadratic_stiffness": (c / most * r.choice([-.5, 1]), 0, 0), "cubic_stiffness": (0, c / most**2 * r.choice([-.5, 1]), 0), "drag": (0, 0, 2 * c / slope)}
            hidden.append((k, {"spring": spring[kind]}))
        elif kind == "switch_delay":
            hidden.append((1, {"late": r.uniform(1, 9) / rate}))
        elif kind == "capacitor_mismatch":
            k = int(r.choice([k for k, b in enumerate(blocks) if b in ("pole_zero", "biquad")]))
            key = str(r.choice(["pole_hz", "zero_hz"] if blocks[k] == "pole_zero" else ["natural_frequency_hz"]))
            hidden.append((k, {"ratios": {key: 1 + r.choice([-1, 1]) * r.uniform(.02, .15)}}))
        else:
            place = len(blocks) if kind in BEHIND or kind in ("glitches", "vibration", "lost_samples", "warming") else int(r.integers(0, len(blocks) + 1))
            hidden.append((place, effect(r, kind, nodes[place], rate, hz, seconds, unipolar,
                                         all(b not in SMOOTH and v.get("highpass_gain", 1.0) for b, v in zip(blocks[place:], values[place:])))))
            if hidden[-1][1] is None:
                return None
    run = lambda values, active: [simulated(blocks, values, hidden, u, rate, i, active) for i, u in enumerate(inputs)]
    ys = run(values, [True] * len(kinds))
    train = lambda ys: np.concatenate(ys[:-1])
    columns, span = [], float(np.ptp(train(ys)))
    for k, names in enumerate(free):
        for key in names:
            moved = [dict(v) for v in values]
            moved[k][key] *= 1.01
            columns.append(train(run(moved, [True] * len(kinds))) - train(ys))
    adds = [train(ys) - train(run(values, [j != k for j in range(len(kinds))])) for k in range(len(kinds))]
    sizes = []
    for k, added in enumerate(adds):
        against = columns + adds[:k] + adds[k + 1:]
        if against:
            m = np.stack([c / (np.linalg.norm(c) or 1) for c in against], 1)
            added = added - m @ np.linalg.lstsq(m, added, rcond=1e-9)[0]
        sizes.append(math.sqrt(np.mean(added**2)))
    if sizes and not (.001 * span < min(sizes) and max(sizes) < min(12 * min(sizes), .2 * span)):
        return None  # never reached, or out of all proportion
    times = math.exp(r.uniform(math.log(5 if what == "outside" else 4), math.log(60)))
    sigma = min(sizes) / times if sizes else span * math.exp(r.uniform(math.log(1e-4), math.log(.02)))
    colour = str(r.choice(["white", "converter", "red", "flicker", "hum"], p=[.35, .2, .2, .17, .08]))
    if colour == "hum" and (not kinds or rate < 150 or 50 * seconds < 4 or "mains_hum" in kinds):
        colour = "white"
    os.makedirs(folder, exist_ok=True)
    for letter, u, y in zip(["a", "b", "c"][:count] + ["h"], inputs, ys):
        np.savetxt(f"{folder}/{letter}.csv", np.c_[np.arange(n) / rate, u, noise(r, colour, y, sigma, rate)], delimiter=",", header="time_s,u,y", comments="", fmt="%.12g")
    off = lambda key, v: v * math.exp(r.uniform(-.05, .05) * (.5 if key == "natural_frequency_hz" else 1))
    with open(f"{folder}/model.toml", "w") as out:
        out.write('schema = "bodesmith.model/1"\n')
        for kind, v, names in zip(blocks, values, free):
            shown = {key: off(key, x) if key in names else x for key, x in v.items()}
            lines = [f"{key} = {[float(f'{y:.10g}') for y in x] if isinstance(x, list) else f'{x:.10g}'}" for key, x in shown.items()]
            out.write(f'[[block]]\ntype = "{kind}"\n' + "\n".join(lines) + (f"\nfree = {names}\n".replace("'", '"') if names else "\n"))
    outside = kinds[0] if what == "outside" else None
    return {"kinds": [] if outside else kinds, "base": base, "noise": colour, "times": times, "outside": outside, "places": [p for p, _ in hidden],
            "sizes": [s / sigma for s in sizes], "shapes": [str(s) for s in shapes[:count]], "rate_hz": rate, "seed": name, "sigma": sigma, "span": span,
            "allowed": ["mains_hum"] if colour == "hum" else [], "unipolar": bool(unipolar)}
