#!/usr/bin/env python3
"""Prints the table "What the examples come to" of docs/fpaa.md: sections of many kinds put on a board, with what the plans state.

Then the tables of cases that nothing was tuned on.

Usage: docs/make_fpaa_table.py [path of bodesmith] [name …]     (default build/bin/bodesmith, all names; run ./run first)
"""
import json
import math
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TURN = 2 * math.pi


def pair(hz, quality):
    """Complex roots of a natural frequency and a quality."""
    w = TURN * hz
    root = complex(-w / (2 * quality), w * math.sqrt(1 - 1 / (4 * quality ** 2)))
    return [root, root.conjugate()]


def notch(hz):
    return [complex(0, TURN * hz), complex(0, -TURN * hz)]


def real(*hz):
    return [-TURN * f for f in hz]


def spread(first, last, count):
    return [first * (last / first) ** (i / (count - 1)) for i in range(count)]


PAPER = [(0.918, [-48.79, -14.8], [-47.49, -13.99]), (1.885, [-107.6, -63.68], [-126.4, -102.2]),
         (0.318, [-380.2, -221.6], [-214.9, -124.8]), (2.628, [-400.0, -365.6], [-652.1, -589.4])]
A = [20.598997, 20.598997, 107.65265, 737.86223, 12194.217, 12194.217]
TOP = (TURN * A[4]) ** 2
SIXTEEN = spread(10, 4380, 32)
COMPLEX = spread(50, 3370, 8)
RIGHT = pair(1000, 1)

# Name, band (None: as fpaa chooses it), and a command or (gain, zeros, poles) of each section.
CASES = [
    ("the paper's eight sections", (1, 100), PAPER),
    ("A-weighting, order 4", None, "fit examples/a_weighting/points.csv --direct --order 4"),
    ("A-weighting, order 6", (20, 20e3), "fit examples/a_weighting/points.csv --direct --order 6"),
    ("A-weighting, exact poles", (20, 20e3),
     [(1, [0, 0], real(A[0], A[1])), (1, [0, 0], real(A[2], A[3])), (1.2589 * TOP, [], real(A[4], A[5]))]),
    ("C-weighting, exact poles", (20, 20e3), [(1, [0, 0], real(A[0], A[1])), (1.0072 * TOP, [], real(A[4], A[5]))]),
    ("RIAA", (20, 20e3), [(1, [-1 / 318e-6], [-1 / 3180e-6]), (9.898 * 0.1 / 75e-6, [], [-1 / 75e-6])]),
    ("pink noise, order 6", None, "fit examples/pink_noise/points.csv --direct --order 6"),
    ("constant-phase element (cascade)", None, "approximate examples/constant_phase_element/cascade.json --order 6"),
    ("constant-phase element (element)", None,
     "approximate examples/constant_phase_element/element.toml --from-hz 1 --to-hz 10000 --order 6"),
    ("fractional PID, order 4", None, "approximate examples/fractional_pid/pid.toml --from-hz 0.1 --to-hz 1000 --order 4"),
    ("fractional PID, order 6", None, "approximate examples/fractional_pid/pid.toml --from-hz 0.1 --to-hz 1000 --order 6"),
    ("eight pole-zero pairs, 2 to 350 Hz", (1, 350),
     [(1, real(1.15 * f), real(f)) for f in spread(2, 350, 8)]),
    ("sixteen real poles", None,
     [(1, real(z), real(p)) for p, z in zip(SIXTEEN[0::2], SIXTEEN[1::2])]),
    ("eight complex pairs with complex zeros", None, [(1, pair(1.1 * f, 1.2), pair(f, 1.5)) for f in COMPLEX]),
    ("two corners six decades apart", None, [(1, [-1.5], [-1.0]), (1, [-2e5], [-3e5])]),
    ("four pairs over six decades", (0.02, 20e3), [(1, real(1.6 * f), real(f)) for f in (0.02, 2, 200, 12500)]),
    ("three pole-zero pairs", None, [(1, real(15), real(10)), (1, real(300), real(200)), (1, real(4000), real(3000))]),
    ("double pole 50 Hz, pair at 400 Hz", (1, 5000),
     [((TURN * 50) ** 2, real(500), real(50, 50)), (1 / (TURN * 500), pair(500, 0.8), pair(400, 1))]),
    ("high pass, order 2", (10, 200), "design highpass --order 2 --corner-hz 20"),
    ("high pass, order 4", (10, 200), "design highpass --order 4 --corner-hz 20"),
    ("band pass, order 4", (326, 2760), "design bandpass --order 2 --from-hz 600 --to-hz 1500"),
    ("band pass, Q 20", (100, 10e3), [(TURN * 1000 / 20, [0], pair(1000, 20))]),
    ("band stop 45-55 Hz, order 4", (4.63, 107), "design bandstop --order 2 --from-hz 45 --to-hz 55"),
    ("notch 50 Hz, Q 2", (5, 500), [(1, notch(50), pair(50, 2))]),
    ("notch 1 kHz, Q .7, to 20 kHz", (10, 20e3), [(1, notch(1000), pair(1000, 0.7))]),
    ("elliptic low pass, order 5", (428, 2300), "design lowpass --family elliptic --order 5 --corner-hz 1000"),
    ("Chebyshev low pass, order 6", (177, 498), "design lowpass --family chebyshev1 --order 6 --corner-hz 500"),
    ("Butterworth low pass, order 4", (100, 3000), "design lowpass --order 4 --corner-hz 1000"),
    ("Butterworth low pass, order 16", (100, 2000), "design lowpass --order 16 --corner-hz 1000"),
    ("Bessel low pass, order 4", (286, 6410), "design lowpass --family bessel --order 4 --corner-hz 1000"),
    ("low pass, order 1, 500 Hz", (50, 3000), [(TURN * 500, [], real(500))]),
    ("all pass, order 1", (1, 10e3), [(-1, [TURN * 100], real(100))]),
    ("all pass, order 2", (10, 20e3), [(1, [-p.conjugate() for p in RIGHT], RIGHT)]),
    ("right-half-plane zero", (1, 20e3), [(-0.2, [TURN * 1000], real(200))]),
    ("right-half-plane pair", (10, 10e3),
     [(1, [complex(300, TURN * 300), complex(300, -TURN * 300)], pair(400, 0.8))]),
    ("peaking equaliser", (20, 20e3), "design peaking --corner-hz 1000 --q 2 --gain-db 6"),
]


# Cases that nothing was tuned on, as they were drawn: by the date of the search that they judged first.
FRESH = {
    "2026-11-23": [
        ("Butterworth 3, 250 Hz", (25, 1000), "design lowpass --order 3 --corner-hz 250"),
        ("Bessel 5, 3 kHz", (100, 8000), "design lowpass --family bessel --order 5 --corner-hz 3000"),
        ("Chebyshev 4, 2 kHz", (100, 2000), "design lowpass --family chebyshev1 --order 4 --corner-hz 2000"),
        ("peaking 300 Hz, Q 1, -8 dB", (20, 5000), "design peaking --corner-hz 300 --q 1 --gain-db -8"),
        ("low shelf 120 Hz, +9 dB", (10, 5000), "design low-shelf --corner-hz 120 --gain-db 9"),
        ("high shelf 3 kHz, -6 dB", (20, 20000), "design high-shelf --corner-hz 3000 --gain-db -6"),
        ("band pass 90-160 Hz, order 6", (40, 400), "design bandpass --order 3 --from-hz 90 --to-hz 160"),
        ("high pass 3, 150 Hz", (75, 3000), "design highpass --order 3 --corner-hz 150"),
        ("five pole-zero pairs, 3 to 80 Hz", (1, 200), [(1, real(1.3 * f), real(f)) for f in spread(3, 80, 5)]),
        ("RIAA with 20 Hz high pass", (20, 20e3),
         [(1, [-1 / 318e-6], [-1 / 3180e-6]), (1, [0], real(20)), (9.898 * 0.1 / 75e-6, [], [-1 / 75e-6])]),
    ],
    "2026-11-24": [
        ("Butterworth 3, 700 Hz", (30, 2500), "design lowpass --order 3 --corner-hz 700"),
        ("Bessel 3, 900 Hz", (50, 3000), "design lowpass --family bessel --order 3 --corner-hz 900"),
        ("Chebyshev 5, 1.8 kHz", (50, 1800), "design lowpass --family chebyshev1 --order 5 --corner-hz 1800"),
        ("high pass 3, 90 Hz", (40, 2000), "design highpass --order 3 --corner-hz 90"),
        ("band pass 250-480 Hz, order 4", (150, 900), "design bandpass --order 2 --from-hz 250 --to-hz 480"),
        ("elliptic 3, 400 Hz", (30, 900), "design lowpass --family elliptic --order 3 --corner-hz 400"),
        ("peaking 400 Hz, Q 1.3, +5 dB", (20, 8000), "design peaking --corner-hz 400 --q 1.3 --gain-db 5"),
        ("peaking 2.5 kHz, Q 3, -9 dB", (20, 20e3), "design peaking --corner-hz 2500 --q 3 --gain-db -9"),
    ],
    "2026-11-25": [
        ("Butterworth 5, 320 Hz", (20, 1200), "design lowpass --order 5 --corner-hz 320"),
        ("Bessel 6, 1.5 kHz", (50, 4000), "design lowpass --family bessel --order 6 --corner-hz 1500"),
        ("Chebyshev high pass 4, 600 Hz", (500, 8000), "design highpass --family chebyshev1 --order 4 --corner-hz 600"),
        ("band pass 1.2-2.1 kHz, order 4", (600, 4000), "design bandpass --order 2 --from-hz 1200 --to-hz 2100"),
        ("elliptic 4, 2.5 kHz", (100, 6000), "design lowpass --family elliptic --order 4 --corner-hz 2500 --stop-db 45"),
        ("peaking 80 Hz, Q 4, +10 dB", (10, 2000), "design peaking --corner-hz 80 --q 4 --gain-db 10"),
        ("low shelf 300 Hz, -7 dB", (20, 10e3), "design low-shelf --corner-hz 300 --gain-db -7"),
        ("seven pole-zero pairs, 5 to 500 Hz", (1, 1000), [(1, real(1.4 * f), real(f)) for f in spread(5, 500, 7)]),
        ("notch 60 Hz, Q 1", (6, 600), [(1, notch(60), pair(60, 1))]),
        ("NAB tape playback, 50 and 3180 us", (20, 15e3), [(50e-6 / 3180e-6, [-1 / 50e-6], [-1 / 3180e-6])]),
    ],
}


def roots(list_of):
    return [[complex(r).real, complex(r).imag] for r in list_of]


def write_sections(program, what, file):
    if isinstance(what, str):
        words = [str(ROOT / w) if w.startswith("examples/") else w for w in what.split()]
        subprocess.run([program, *words, "-o", file, "--quiet"], check=False, capture_output=True)
        return
    sections = [{"gain": k, "zeros_rad_s": roots(z), "poles_rad_s": roots(p)} for k, z, p in what]
    file.write_text(json.dumps({"schema": "bodesmith.sections/1", "gain": 1.0, "sections": sections}))


def verdict(total):
    """What is wanted of every row and missed: .5 % designed, 1.5 % for 95 % of boards, 1 V or two thirds of the largest gain's bound."""
    input_kept = total["at_input_v"] >= 1 or total["from_bound_db"] >= 20 * math.log10(2 / 3)
    missed = [word for word, kept in (("designed", total["designed_percent"] <= 0.5), ("95 %", total["p95_percent"] <= 1.5),
                                      ("input", input_kept)) if not kept]
    return ", ".join(missed) or "all kept"


def hertz(value):
    return f"{value:.3g}" if value < 1000 else f"{float(f'{value:.3g}'):.0f}"


def row(program, name, band, what, folder):
    file = folder / "sections.json"
    write_sections(program, what, file)
    asked = ["--from-hz", str(band[0]), "--to-hz", str(band[1])] if band else []
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([program, "fpaa", file, "-o", folder / "plan", "--quiet", *asked], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if not (folder / "plan/plan.json").exists() or done.returncode == 2:
        return f"| {name} | {done.stderr.strip().splitlines()[-1] if done.stderr else 'refused'} |"
    plan = json.loads((folder / "plan/plan.json").read_text())
    (folder / "plan/plan.json").unlink()
    total = plan["total"]
    cams = [cam for chip in plan["chips"] for cam in chip["cams"]]
    opamps = sum(chip["resources"]["opamps"] for chip in plan["chips"])
    clocks = len({cam["clock_a_hz"] for cam in cams})
    low, high = plan["error_with_delays"]["band_hz"]
    return (f"| {name}, {hertz(low)} to {hertz(high)} Hz | {total['designed_percent']:.2g} % | {total['p95_percent']:.2g} % | "
            f"{plan['topology']} | {opamps}, {len(plan['chips'])}, {clocks} | {total['at_input_v']:.3g} | "
            f"{total.get('from_bound_db', 0.0):.1f} | {total['image_percent']:.2g} % | {seconds:.1f} | {verdict(total)} |")


def main():
    program = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/bin/bodesmith").resolve()
    names = sys.argv[2:]
    with tempfile.TemporaryDirectory() as folder:
        for head, cases in {"example": CASES, **{f"drawn {date}": cases for date, cases in FRESH.items()}}.items():
            cases = [case for case in cases if not names or case[0] in names]
            if not cases:
                continue
            print(f"\n| {head} | designed | 95 % | topology | op-amps, chips, clocks | input, V | dB from bound | images | CPU, s | "
                  "kept or missed |\n|---|---|---|---|---|---|---|---|---|---|")
            for name, band, what in cases:
                print(row(program, name, band, what, pathlib.Path(folder)), flush=True)


if __name__ == "__main__":
    main()
