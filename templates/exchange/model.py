"""{{source}} rebuilt with python-control (pip install control), written by bodesmith.

Blocks in series, first to last: x' = A x + b u, y = c x + d u, then delayed. Offsets are left out.
`python3 {{name}}.py` compares it with responses that bodesmith computed.
"""
import numpy as np

# name, A row by row, b, c, d, delay in s
BLOCKS = [
{{#blocks}}
    ("{{name}}", [{{a}}], [{{b}}], [{{c}}], {{d}}, {{delay_s}}),
{{/blocks}}
]
# frequency in Hz, response
CHECKS = [
{{#checks}}
    ({{frequency_hz}}, {{response}}),
{{/checks}}
]
DELAY_S = sum(block[5] for block in BLOCKS)


def matrices(block):
    """A, B, C, D of one block as arrays."""
    _, a, b, c, d, _ = block
    n = len(b)
    return np.reshape(a, (n, n)), np.reshape(b, (n, 1)), np.reshape(c, (1, n)), np.array([[d]])


def blocks():
    """The blocks as control.StateSpace objects, first to last, without their delays."""
    import control

    return [control.ss(*matrices(block)) for block in BLOCKS]


def system():
    """The whole chain without its delay (DELAY_S)."""
    import control

    out = control.ss([], [], [], [[1.0]])
    for block in blocks():
        out = control.series(out, block)
    return out


def response(frequency_hz):
    """H at one frequency, block by block."""
    s = 2j * np.pi * frequency_hz
    h = np.exp(-s * DELAY_S)
    for block in BLOCKS:
        a, b, c, d = matrices(block)
        gain = d[0, 0]
        if len(b):
            gain = gain + (c @ np.linalg.solve(s * np.eye(len(b)) - a, b))[0, 0]
        h *= gain
    return h


if __name__ == "__main__":
    off = max(abs(response(f) / h - 1.0) for f, h in CHECKS)
    print(f"matrices: off by at most {off:.1e} at {len(CHECKS)} frequencies")
    worst = 0.0
    try:
        chain = blocks()
    except ImportError:
        print("python-control is not installed")
        chain = None
    if chain is not None:
        for f, h in CHECKS:
            s = 2j * np.pi * f
            got = np.exp(-s * DELAY_S)
            for block in chain:
                got *= complex(np.squeeze(block(s)))
            worst = max(worst, abs(got / h - 1.0))
        print(f"python-control, block by block: off by at most {worst:.1e}")
    raise SystemExit(0 if max(off, worst) < 1e-9 else 1)
