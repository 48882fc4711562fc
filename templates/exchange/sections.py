"""{{source}} rebuilt with python-control (pip install control), written by bodesmith.

H(s) = GAIN * prod_i gain_i * prod(s - zero)/prod(s - pole) * exp(-s DELAY_S), zeros and poles in rad/s.
`python3 {{name}}.py` compares it with responses that bodesmith computed.
"""
import cmath
import math

GAIN = {{gain}}
DELAY_S = {{delay_s}}
# gain, zeros, poles of every section
SECTIONS = [
{{#sections}}
    ({{gain}}, [{{zeros}}], [{{poles}}]),
{{/sections}}
]
# frequency in Hz, response
CHECKS = [
{{#checks}}
    ({{frequency_hz}}, {{response}}),
{{/checks}}
]


def sections():
    """The sections as control.TransferFunction objects, first to last; GAIN is not in them."""
    import control

    return [control.zpk(zeros, poles, gain) for gain, zeros, poles in SECTIONS]


def system():
    """The whole chain without its delay."""
    import control

    out = control.tf([GAIN], [1.0])
    for section in sections():
        out = control.series(out, section)
    return out


def response(frequency_hz):
    """H at one frequency, from the factors themselves: exact where a polynomial of high order is not."""
    s = 2j * math.pi * frequency_hz
    h = GAIN * cmath.exp(-s * DELAY_S)
    for gain, zeros, poles in SECTIONS:
        h *= gain
        for zero in zeros:
            h *= s - zero
        for pole in poles:
            h /= s - pole
    return h


if __name__ == "__main__":
    off = max(abs(response(f) / h - 1.0) for f, h in CHECKS)
    print(f"factors: off by at most {off:.1e} at {len(CHECKS)} frequencies")
    chain = sections()
    worst = 0.0
    for f, h in CHECKS:
        s = 2j * math.pi * f
        got = GAIN * cmath.exp(-s * DELAY_S)
        for section in chain:
            got *= complex(section(s))
        worst = max(worst, abs(got / h - 1.0))
    print(f"python-control, section by section: off by at most {worst:.1e}")
    raise SystemExit(0 if max(off, worst) < 1e-9 else 1)
