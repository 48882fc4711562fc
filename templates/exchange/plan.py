"""{{source}} rebuilt with python-control (pip install control), written by bodesmith.

CAMs of an FPAA, each sampled at its own clock, without holds and delays: H(z) = sum over inputs of
(n0 + n1/z + ...)/(d0 + d1/z + ...) times what feeds it, z = exp(2 pi j f/clock).
`python3 {{name}}.py` compares it with responses that bodesmith computed.
"""
import cmath
import math

# name, clock in Hz, [(fed by, numerator), ...], denominator; "" is the input of the board. Each stands behind those that feed it.
CAMS = [
{{#blocks}}
    ("{{name}}", {{clock_hz}}, [{{#inputs}}("{{from}}", [{{numerator}}]), {{/inputs}}], [{{denominator}}]),
{{/blocks}}
]
OUTPUT = "{{output}}"
# frequency in Hz, response
CHECKS = [
{{#checks}}
    ({{frequency_hz}}, {{response}}),
{{/checks}}
]


def cams():
    """{(name, fed by): control.TransferFunction with dt = 1/clock}."""
    import control

    out = {}
    for name, clock, inputs, denominator in CAMS:
        for source, numerator in inputs:
            size = max(len(numerator), len(denominator))  # in powers of z, highest first
            pad = [list(p) + [0.0] * (size - len(p)) for p in (numerator, denominator)]
            out[name, source] = control.tf(*pad, 1.0 / clock)
    return out


def polynomial(coefficients, z):
    return sum(c * z**-k for k, c in enumerate(coefficients))


def response(frequency_hz):
    """From the board's input to its output at one frequency."""
    signal = {"": 1.0}
    for name, clock, inputs, denominator in CAMS:
        z = cmath.exp(2j * math.pi * frequency_hz / clock)
        got = sum(polynomial(n, z) * signal.get(source, 0.0) for source, n in inputs)
        signal[name] = got / polynomial(denominator, z)
    return signal[OUTPUT]


if __name__ == "__main__":
    off = max(abs(response(f) / h - 1.0) for f, h in CHECKS)
    print(f"z transfers: off by at most {off:.1e} at {len(CHECKS)} frequencies")
    worst = 0.0
    try:
        systems = cams()
    except ImportError:
        print("python-control is not installed")
        systems = None
    if systems is not None:
        for f, h in CHECKS:
            signal = {"": 1.0}
            for name, clock, inputs, _ in CAMS:
                z = cmath.exp(2j * math.pi * f / clock)
                signal[name] = sum(complex(systems[name, source](z)) * signal.get(source, 0.0) for source, _ in inputs)
            worst = max(worst, abs(signal[OUTPUT] / h - 1.0))
        print(f"python-control, CAM by CAM: off by at most {worst:.1e}")
    raise SystemExit(0 if max(off, worst) < 1e-9 else 1)
