"""Op-amps' noise of `sc` against the circuit with op-amps of one pole: a linear system that jumps when switches move.

The state is the op-amps' outputs x and the charges q that no node holds: dx/dt = W (v(plus) - v(minus) + e), q constant, e white;
where the switches move, charges are summed anew. The density at f is (1/T) times the integral of |B' m|^2 over a period, m the
periodic solution of the adjoint equation -dm/dt = (A' - jw) m + c. Exact, settled or not; nothing is shared with the program.
"""

import re

import numpy as np
import pytest
from conftest import run

UNITS = {"": 1.0, "p": 1e-12, "n": 1e-9, "k": 1e3, "meg": 1e6}

INTEGRATOR = """.clock main 100k
V1 in 0
S1 in u main.1
S2 u 0 main.2
S3 w n main.1
S4 w 0 main.2
Cin u w 2p
S5 out u2 main.1
S6 u2 0 main.2
S7 w2 n main.1
S8 w2 0 main.2
Cfb u2 w2 1p
Cint n out 5p
O1 0 n out noise=20n gbw=GBW
.output out
"""

# Two op-amps in one loop, the second with a path through both phases, noise of its own.
RESONATOR = """.clock main 100k
V1 in 0
S1 in u main.1
S2 u 0 main.2
S3 w n1 main.1
S4 w 0 main.2
Cin u w 2p
S5 o2 u2 main.1
S6 u2 0 main.2
S7 w2 n1 main.1
S8 w2 0 main.2
Cfb u2 w2 1.5p
Ci1 n1 o1 5p
O1 0 n1 o1 noise=20n gbw=GBW
S11 o1 v1 main.1
S12 v1 0 main.2
S13 x1 0 main.1
S14 x1 n2 main.2
Cc v1 x1 1p
Cq n1 o2 1p
Ci2 n2 o2 4p
O2 0 n2 o2 noise=35n gbw=GBW
.output o2
"""

# A buffer that is sampled: its noise while the switch is closed, and what is held of it.
SAMPLED = """.clock main 100k
V1 in 0
O1 in b b noise=20n gbw=GBW
S1 b c main.1
C1 c 0 1p
.output c
"""


def value(word):
    number, unit = re.fullmatch(r"([\d.]+)([a-z]*)", word).groups()
    return float(number) * UNITS[unit]


class Circuit:
    def __init__(self, text):
        words = [line.split() for line in text.splitlines()]
        self.capacitors = [(w[1], w[2], value(w[3])) for w in words if w[0][0] == "C"]
        self.switches = [(w[1], w[2], int(w[3][-1])) for w in words if w[0][0] == "S"]
        self.opamps = [(*w[1:4], *(value(x.split("=")[1]) for x in w[4:])) for w in words if w[0][0] == "O"]
        self.period_s = 1.0 / next(value(w[2]) for w in words if w[0] == ".clock")
        self.output = next(w[1] for w in words if w[0] == ".output")
        elements = self.capacitors + self.switches + self.opamps
        self.nodes = sorted({"0", "in"} | {n for e in elements for n in e[:3] if isinstance(n, str)})
        self.phases = [self.phase(1), self.phase(2)]

    def phase(self, number):
        """Charges and op-amps' outputs to node voltages and plates' charges while the switches of a phase are closed."""
        at = {n: i for i, n in enumerate(self.nodes)}
        group = list(range(len(at)))
        for a, b, phase in self.switches:
            if phase == number:
                old, new = group[at[a]], group[at[b]]
                group = [new if g == old else g for g in group]
        size = np.zeros((len(at), len(at)))
        for a, b, farad in self.capacitors:
            i, j = at[a], at[b]
            size[[i, j, i, j], [i, j, j, i]] += [farad, farad, -farad, -farad]
        held = {group[at["0"]], group[at["in"]]}
        of_outputs = np.zeros((len(at), len(self.opamps)))
        for k, amp in enumerate(self.opamps):
            held.add(group[at[amp[2]]])
            of_outputs[[g == group[at[amp[2]]] for g in group], k] = 1.0
        free = [g for g in sorted(set(group) - held) if any(size[i, i] > 0 for i in range(len(at)) if group[i] == g)]
        members = np.array([[g == of for g in group] for of in free], float).reshape(len(free), len(at))
        by_charge = members.T @ np.linalg.inv(members @ size @ members.T)
        by_output = of_outputs - by_charge @ members @ size @ of_outputs
        rates = np.diag([2 * np.pi * amp[4] for amp in self.opamps])
        difference = np.zeros((len(self.opamps), len(at)))
        for k, amp in enumerate(self.opamps):
            difference[k, at[amp[0]]] += 1.0
            difference[k, at[amp[1]]] -= 1.0
        charges = len(free)
        law = np.vstack([rates @ difference @ np.hstack([by_output, by_charge]), np.zeros((charges, len(self.opamps) + charges))])
        noise = np.vstack([rates @ np.diag([amp[3] / np.sqrt(2) for amp in self.opamps]), np.zeros((charges, len(self.opamps)))])
        plates = size @ np.hstack([by_output, by_charge])
        return law, noise, plates, members, np.hstack([by_output, by_charge])[at[self.output]]

    def density(self, hz):
        """V/rtHz."""
        half, w, amps = 0.5 * self.period_s, 2 * np.pi * hz, len(self.opamps)
        steps = []
        for i in (0, 1):
            law, noise, plates, _, read = self.phases[i]
            members = self.phases[1 - i][3]
            jump = np.vstack([np.eye(amps, law.shape[0]), members @ plates])
            turning = law.T - 1j * w * np.eye(len(read))
            steps.append((np.block([[turning, read[:, None]], [np.zeros((1, len(read) + 1))]]), jump, noise))

        def before(i, m):
            back = exponential(steps[i][0] * half)
            return back[:-1, :-1] @ (steps[i][1].T @ m) + back[:-1, -1]

        def turn(m):
            return before(0, before(1, m))

        size = steps[0][0].shape[0] - 1
        still = turn(np.zeros(size))
        loop = np.column_stack([turn(column) - still for column in np.eye(size)])
        m = np.linalg.solve(np.eye(size) - loop, still)
        total = 0.0
        for i in (1, 0):
            law, jump, noise = steps[i]
            end = jump.T @ m
            # The adjoint decays as op-amps settle: panels from a fiftieth of their time constant on.
            edges = np.concatenate([[0.0], np.geomspace(min(half, 0.02 / abs(law[:-1, :-1]).max()), half, 50)])
            points, weights = np.polynomial.legendre.leggauss(5)
            for a, b in zip(edges, edges[1:]):
                for x, weight in zip(points, weights):
                    back = exponential(law * (0.5 * (a + b) + 0.5 * (b - a) * x))
                    total += 0.5 * (b - a) * weight * np.sum(abs(noise.T @ (back[:-1, :-1] @ end + back[:-1, -1])) ** 2)
            m = before(i, m)
        return np.sqrt(2.0 * total / self.period_s)


def exponential(a):
    """By Taylor's series of a 2^-n th part, squared n times."""
    halvings = max(0, int(np.ceil(np.log2(max(1e-9, np.abs(a).sum(axis=1).max())))) + 3)
    a = a / 2.0**halvings
    term = out = np.eye(len(a), dtype=complex)
    for k in range(1, 15):
        term = term @ a / k
        out = out + term
    for _ in range(halvings):
        out = out @ out
    return out


@pytest.mark.parametrize("text", [INTEGRATOR, RESONATOR, SAMPLED], ids=["integrator", "resonator", "sampled"])
@pytest.mark.parametrize("gbw, within_db", [("10meg", 0.04), ("700k", 0.15)])
def test_opamp_noise_is_that_of_one_pole(tmp_path, text, gbw, within_db):
    """To half the clock, all folding in it; .3 dB is what is asked, at ten time constants and more in a phase."""
    text = text.replace("GBW", gbw)
    (tmp_path / "x.sc").write_text(text)
    done = run("sc", "x.sc", "--noise", "--temperature-k", "1e-9", "--from-hz", 300, "--to-hz", 50e3, "--count", 5, "-o", "x.csv", cwd=tmp_path)
    assert done.status == 0, done.err
    circuit = Circuit(text)
    for hz, told in np.loadtxt(tmp_path / "x.csv", delimiter=",", skiprows=1, comments="#"):
        assert abs(20 * np.log10(told / circuit.density(hz))) < within_db, hz


def test_switches_and_opamps_add(tmp_path):
    """Their noise is independent: squares of densities add. A bandwidth too small for the clock is said."""
    (tmp_path / "both.sc").write_text(INTEGRATOR.replace("GBW", "10meg"))
    (tmp_path / "switches.sc").write_text(INTEGRATOR.replace(" noise=20n gbw=GBW", ""))
    squares = {}
    for name, file, temperature in (("both", "both", 300), ("opamps", "both", 1e-9), ("switches", "switches", 300)):
        run("sc", f"{file}.sc", "--noise", "--temperature-k", temperature, "--count", 4, "-o", "x.csv", cwd=tmp_path)
        squares[name] = np.loadtxt(tmp_path / "x.csv", delimiter=",", skiprows=1, comments="#")[:, 1] ** 2
    assert np.allclose(squares["both"], squares["opamps"] + squares["switches"], rtol=1e-6)
    (tmp_path / "slow.sc").write_text(INTEGRATOR.replace("GBW", "100k"))
    assert "time constants" in run("sc", "slow.sc", "--noise", "-o", "x.csv", cwd=tmp_path).err
    (tmp_path / "half.sc").write_text(INTEGRATOR.replace(" gbw=GBW", ""))
    half = run("sc", "half.sc", "--noise", "-o", "x.csv", cwd=tmp_path)
    assert half.status == 2 and half.err.startswith("bodesmith: half.sc:14: ") and half.err.count("\n") == 1
