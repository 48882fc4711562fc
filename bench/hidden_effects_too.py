"""A second generator of hidden effects, by another hand and with equations of its own (bench/calibration.py draws from both).

The base is a gain, a pole, a resonator, branch polynomials or two poles; records are of 1, 2 or 10 kHz. One or two effects of the
catalogue are hidden in front of the base (offset, drift and hum behind it), nothing, or a form outside the catalogue. Noise is white,
red or 1/f, a fifth to a fiftieth of the effects' rms.
"""
import math
import os

import numpy as np

from hidden_effects import rest

FINE = 8  # steps inside a sample


def lag(u, dt, hz):
    """Exact for an input that goes straight between the steps."""
    a = 2 * np.pi * hz * dt
    e = math.exp(-a)
    g = (1 - e) / a
    y = np.zeros_like(u)
    for i in range(1, len(u)):
        y[i] = e * y[i - 1] + (g - e) * u[i - 1] + (1 - g) * u[i]
    return y


def resonator(u, dt, hz, zeta, quadratic=0.0, cubic=0.0, drag=0.0):
    w = 2 * np.pi * hz
    y = np.zeros_like(u)
    x = v = 0.0

    def slope(x, v, u):
        return v, w * w * (u - x - quadratic * x * x - cubic * x**3) - 2 * zeta * w * v - drag * w * abs(v) * v

    for i in range(1, len(u)):
        if abs(x) > 100:
            y[i:] = np.inf
            break
        u0, u1 = u[i - 1], u[i]
        um = .5 * (u0 + u1)
        k1 = slope(x, v, u0)
        k2 = slope(x + dt / 2 * k1[0], v + dt / 2 * k1[1], um)
        k3 = slope(x + dt / 2 * k2[0], v + dt / 2 * k2[1], um)
        k4 = slope(x + dt * k3[0], v + dt * k3[1], u1)
        x += dt / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        v += dt / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
        y[i] = x
    return y


def delayed(u, dt, seconds):
    t = np.arange(len(u)) * dt
    return np.interp(t - seconds, t, u, left=0.0)


def play(u, width):
    y = np.zeros_like(u)
    s = 0.0
    for i, v in enumerate(u):
        s = max(v - width / 2, min(v + width / 2, s))
        y[i] = s
    return y


def bouc_wen(u, a, beta, gamma):
    y = np.zeros_like(u)
    z = 0.0
    for i in range(1, len(u)):
        d = (u[i] - u[i - 1]) / 2
        for _ in range(2):
            z += a * d - beta * abs(d) * z - gamma * d * abs(z)
        y[i] = z
    return y


def slewed(u, dt, rate):
    y = np.zeros_like(u)
    for i in range(1, len(u)):
        y[i] = y[i - 1] + max(-rate * dt, min(rate * dt, u[i] - y[i - 1]))
    return y


def fractional(u, dt, lam, x, beta):
    """((lam s + 1)/(x lam s + 1))^beta over a padded spectrum."""
    n = len(u)
    m = 4 * n
    s = 2j * np.pi * np.fft.rfftfreq(m, dt)
    padded = np.concatenate([u, np.linspace(u[-1], 0, n), np.zeros(m - 2 * n)])
    return np.fft.irfft(np.fft.rfft(padded) * ((lam * s + 1) / (x * lam * s + 1)) ** beta, m)[:n]


def branches(u, up, down, late):
    """u + up(u) while u rises, u + down(u) while it falls; the branch `late` steps later."""
    sign, now = np.empty(len(u)), 1
    for i, v in enumerate(np.sign(np.diff(u, prepend=u[0]))):
        now = v or now
        sign[i] = now
    if late > 0:
        sign = np.concatenate([np.full(late, 1.0), sign])[:len(u)]
    poly = lambda c: c[0] * u + c[1] * u**2 + c[2] * u**3
    return u + np.where(sign > 0, poly(up), poly(down))


def noise(r, n, colour, rms):
    e = r.standard_normal(n)
    if colour != "white":
        f = np.fft.rfftfreq(n)
        f[0] = f[1]
        e = np.fft.irfft(np.fft.rfft(e) * (1 / np.sqrt(1 + (f / 0.01) ** 2) if colour == "red" else 1 / np.sqrt(f)), n)
    return e / np.std(e) * rms


def drive(r, n, rate, shape, size, hz):
    t = np.arange(n) / rate
    triangle = 2 / np.pi * np.arcsin(np.sin(2 * np.pi * hz * t))
    if shape == "triangles":
        u = triangle
    elif shape == "falling_triangles":
        u = triangle * np.linspace(1, .25, n)
    elif shape == "multisine":
        u = sum(np.sin(2 * np.pi * hz * k * t + r.uniform(0, 6.28)) for k in (1, 3, 5, 7, 11, 13, 17))
        u = u - u[0]
        u /= np.abs(u).max()
        u *= np.minimum(1, t * hz * 2)
    elif shape == "swelling":
        u = np.sin(2 * np.pi * hz * t) * (.6 + .4 * np.sin(2 * np.pi * hz * t / 7.3))
    elif shape == "chirp":
        u = np.sin(2 * np.pi * (hz * .3 * t + (hz * 3 - hz * .3) / 2 / t[-1] * t * t))
    else:  # straight between random levels
        m = max(4, int(n * hz / rate))
        levels = r.uniform(-1, 1, m + 1)
        levels[0] = 0
        u = np.interp(np.arange(n) / n * m, np.arange(m + 1), levels)
    return size * u


STATIC = ["saturation", "dead_zone", "backlash", "quadratic_nonlinearity", "cubic_nonlinearity", "hysteresis"]
SLOW = ["creep", "drift", "mains_hum", "offset"]
SUITS = {
    "gain": ["time_delay", "amplifier_pole", "slew_limit", *STATIC, "creep", "rate_dependence", "drift", "mains_hum", "offset", "sample_hold", "resonance",
             "asymmetric_hysteresis"],
    "pole": ["time_delay", "slew_limit", *STATIC, *SLOW, "sample_hold", "resonance"],
    "resonator": ["time_delay", "amplifier_pole", "slew_limit", "saturation", "backlash", "cubic_stiffness", "quadratic_stiffness", "drag", "hysteresis", *SLOW,
                  "resonance", "asymmetric_hysteresis"],
    "polynomial": ["switch_delay", "time_delay", "amplifier_pole", "gain_error", *SLOW, "resonance"],
    "chain": ["time_delay", "amplifier_pole", "slew_limit", "saturation", "backlash", "cubic_nonlinearity", "hysteresis", *SLOW, "sample_hold", "resonance",
              "gain_error"]}
ALIKE = [{"creep", "drift", "rate_dependence"}, {"time_delay", "amplifier_pole", "resonance", "sample_hold"},
         {"hysteresis", "asymmetric_hysteresis", "backlash"}, {"offset", "mains_hum"},
         {"saturation", "dead_zone", "quadratic_nonlinearity", "cubic_nonlinearity", "cubic_stiffness", "quadratic_stiffness"}]
BEHIND = {"offset", "drift", "mains_hum"}
UP, DOWN = [.36, -.64, .28], [-.24, .08, .16]


def hidden_functions(q, sign, rate, hz, n):
    """Effect: function of (x, step, number of the record); of those inside the base the value."""
    delay, corner, slew = q(.6, 4) / rate, rate / q(8, 60), q(.3, .7)
    low, high, zone, gap = -q(.5, .85), q(.5, .85), q(.1, .4), q(.05, .3)
    square, cube, width, strength, beta = q(.05, .25) * sign(), q(.08, .3) * sign(), q(.05, .25), q(.04, .12), q(.1, .35)
    slope, mains, hum = q(.05, .3) * sign(), 50.0 * (1 + int(q(0, 3))), q(.03, .1)
    constant, held, mode, zeta, loop = q(.04, .2) * sign(), int(q(3, 9)), rate / q(6, 18), q(.02, .2), q(.1, .25)
    inside = {"cubic_stiffness": q(.1, .5), "quadratic_stiffness": q(.1, .4), "drag": q(.1, .6), "switch_delay": q(1.5, 8) / rate}
    gain, taus = 1 + q(.04, .15) * sign(), [q(.3, 1) / hz, q(3, 8) / hz, q(15, 30) / hz]

    def memory(x):
        if width < .17:
            return x + .35 * (play(x, width) + play(x, 2.2 * width) - 2 * x)
        return x + .35 * bouc_wen(x, .8, 2., .7)

    def one_sided(x):
        h = x - play(x, 2 * loop)
        return x - np.where(h > 0, h, 0.35 * h) * .6

    def hold(x, dt):
        k = max(1, round(held / (rate * dt)))
        return x[np.arange(len(x)) // k * k]

    return inside, {
        "time_delay": lambda x, dt, _: delayed(x, dt, delay), "amplifier_pole": lambda x, dt, _: lag(x, dt, corner),
        "slew_limit": lambda x, dt, _: slewed(x, dt, slew * 2 * np.pi * hz), "saturation": lambda x, *_: np.clip(x, low, high),
        "dead_zone": lambda x, *_: np.sign(x) * np.maximum(np.abs(x) - zone / 2, 0), "backlash": lambda x, *_: play(x, gap),
        "quadratic_nonlinearity": lambda x, *_: x + square * x * x, "cubic_nonlinearity": lambda x, *_: x + cube * x**3,
        "hysteresis": lambda x, *_: memory(x), "asymmetric_hysteresis": lambda x, *_: one_sided(x),
        "creep": lambda x, dt, _: x + sum(strength * k * lag(x, dt, 1 / (2 * np.pi * t)) for k, t in zip((1, .8, .9), taus)),
        "rate_dependence": lambda x, dt, _: fractional(x, dt, .05 / (2 * np.pi * hz * .3), 20.0, beta),
        "drift": lambda x, dt, _: x + slope * np.arange(len(x)) * dt / (n / rate),
        "mains_hum": lambda x, dt, record: x + hum * np.sin(2 * np.pi * mains * np.arange(len(x)) * dt + record),
        "offset": lambda x, *_: x + constant, "sample_hold": lambda x, dt, _: hold(x, dt), "resonance": lambda x, dt, _: resonator(x, dt, mode, zeta),
        "gain_error": lambda x, *_: gain * x}


OUTSIDE = {"folds": lambda x, *_: x + .15 * np.abs(x) * np.sign(np.sin(9 * x)), "waves": lambda x, *_: x + .1 * np.exp(.8 * x) * np.sin(4 * x),
           "butterfly": lambda x, *_: x + 1.2 * x * (x - play(x, .5)), "echo": lambda x, dt, rate, _: x + .2 * delayed(x, dt, 23 / rate) * np.sign(x),
           "gain_swings": lambda x, dt, _, hz: x * (1 + .15 * np.sin(2 * np.pi * hz * .37 * np.arange(len(x)) * dt))}


def own_size(base, fixed, rate, with_it, without):
    """rms of what one effect adds to the training records alongside the other, less what the base's free parameters take."""
    if not all(np.isfinite(y).all() for y in with_it + without):
        return math.inf
    left = []
    for y, w in zip(with_it[:2], without):
        absorbed = [] if fixed else [w]
        if base not in ("gain", "polynomial"):
            absorbed += [lag(w, 1 / rate, rate / 20), np.gradient(w)]
        left.append(rest(y - w, *absorbed) if absorbed else np.sqrt(np.mean((y - w) ** 2)))
    return math.sqrt(np.mean(np.square(left)))


def make_case(seed, folder):
    """Writes model.toml, a.csv, b.csv (training) and h.csv (held out); what is hidden."""
    r = np.random.default_rng(seed)
    q, sign = r.uniform, lambda: r.choice([-1, 1])
    rate, n = float(r.choice([1e3, 2e3, 1e4])), int(r.integers(400, 900))
    base = str(r.choice(list(SUITS), p=[.2, .2, .25, .15, .2]))
    kind = str(r.choice(["single", "pair", "control", "outside"], p=[.55, .2, .17, .08]))
    hz, times, colour = rate / q(60, 200), float(r.choice([5, 10, 20, 50])), str(r.choice(["white", "red", "pink"], p=[.5, .25, .25]))
    gain, corner, mode, zeta = q(.5, 3), rate / q(15, 50), rate / q(12, 40), q(.03, .3)
    kinds = [str(r.choice(SUITS[base]))] if kind in ("single", "pair") else []
    if kind == "pair":
        near = next((g for g in ALIKE if kinds[0] in g), set(kinds))
        kinds.append(str(r.choice([e for e in SUITS[base] if e not in near])))
    outside = str(r.choice(list(OUTSIDE))) if kind == "outside" else None
    inside, functions = hidden_functions(q, sign, rate, hz, n)

    def system(x, dt, record, active):
        value = lambda name: inside[name] if name in active else 0.0
        for e in active:
            if e in functions and e not in BEHIND:
                x = functions[e](x, dt, record)
        if outside in active:
            x = OUTSIDE[outside](x, dt, rate, hz)
        if base == "gain":
            x = gain * x
        elif base == "pole":
            x = lag(gain * x, dt, corner)
        elif base == "resonator":
            x = resonator(x, dt, mode, zeta, value("quadratic_stiffness"), value("cubic_stiffness"), value("drag"))
        elif base == "polynomial":
            x = lag(branches(x, UP, DOWN, round(value("switch_delay") / dt)) * gain, dt, corner * 3)
        else:
            x = lag(lag(gain * x, dt, corner), dt, rate / 9)
        for e in active:
            if e in BEHIND:
                x = functions[e](x, dt, record)
        return x

    shapes = ["multisine", "falling_triangles", "swelling", "chirp", "triangles", "levels"]
    r.shuffle(shapes)
    inputs, with_it, without = [], [], []
    hidden = [*kinds, *([outside] if outside else [])]
    without_one = {k: [] for k in hidden}
    for i, f in enumerate([hz, hz * q(.3, .6), hz * q(1.3, 2.2)]):
        u = drive(r, n, rate, shapes[i], .7 if i == 1 else 1., f)
        if base == "polynomial":  # its polynomials are meant for [0, 1]
            u = .5 * (1 - np.cos(2 * np.pi * f * np.arange(n) / rate)) * (np.linspace(1, .5, n) if i == 1 else 1)
        fine, dt = np.interp(np.arange((n - 1) * FINE + 1) / FINE, np.arange(n), u), 1 / rate / FINE
        inputs.append(u)
        with_it.append(system(fine, dt, i, hidden)[::FINE])
        without.append(system(fine, dt, i, [])[::FINE])
        for k in hidden:
            without_one[k].append(system(fine, dt, i, [e for e in hidden if e != k])[::FINE])
    plain = np.concatenate(without)
    if not all(np.isfinite(y).all() and np.abs(y).max() < 100 for y in with_it):  # a spring that gives way
        return make_case(seed + 10**9, folder)
    if kind == "control":
        sigma = np.std(plain) * r.choice([.003, .01, .03])
    else:  # of what a refit of the gain leaves
        gap = np.concatenate(with_it) - plain
        if "gain_error" not in kinds:
            gap = gap - plain * (gap @ plain) / (plain @ plain)
        sigma = max(np.sqrt(np.mean(gap**2)) / times, 1e-6)
    os.makedirs(folder, exist_ok=True)
    for name, u, y in zip("abh", inputs, with_it):
        np.savetxt(f"{folder}/{name}.csv", np.c_[np.arange(n) / rate, u, y + noise(r, n, colour, sigma)], delimiter=",", header="time_s,u,y", comments="",
                   fmt="%.10g")
    block = lambda text, *free: f"[[block]]\n{text}\n" + (f"free = {list(free)}\n".replace("'", '"') if free else "")
    fixed = "gain_error" in kinds
    given = block(f'type = "gain"\ngain = {gain if fixed else 1.05 * gain}', *([] if fixed else ["gain"]))
    pole = lambda hz: block(f'type = "lowpass"\ncorner_hz = {hz}', "corner_hz")
    text = {"gain": given, "pole": given + pole(corner * 1.03), "chain": given + pole(corner * .98) + pole(rate / 9),
            "resonator": block(f'type = "resonator"\ngain = 1.03\nnatural_frequency_hz = {mode * 1.01}\ndamping_ratio = {zeta * 1.1}', "gain",
                               "natural_frequency_hz", "damping_ratio"),
            "polynomial": block(f'type = "polynomial_hysteresis"\nascending = {UP}\ndescending = {DOWN}') + given + pole(corner * 3)}[base]
    with open(f"{folder}/model.toml", "w") as f:
        f.write('schema = "bodesmith.model/1"\n' + text)
    return {"kinds": kinds, "base": base, "noise": colour, "times": times, "outside": outside, "sigma": sigma,
            "sizes": [own_size(base, fixed, rate, with_it, without_one[k]) / sigma for k in hidden]}
