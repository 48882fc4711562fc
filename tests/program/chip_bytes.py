"""What the bytes of AN231 streams make of a sine, from the memory map alone: no plan's figures, no code of the program.

Every capacitor of a CAB is joined by its switch words to op-amps, pins and ground in phase 1 and phase 2 of a clock.
Between switching instants sum C (V(near) - V(carried)) = 0 at every op-amp's inverting input. In the steady state under
exp(jwt) the voltages x of the capacitors repeat after the clocks' common period L but for exp(jwL); the gain is the mean of
v(t) exp(-jwt) over L.
"""

import math

import numpy as np

KEEP, GROUND, INPUT = -1, -2, -3  # nothing joined, ground, the board's input; from 0 on: op-amps


class Chip:
    """Memory of one chip out of its AHF text."""

    def __init__(self, ahf):
        data = [int(word, 16) for word in ahf.split()]
        at = data.index(0xD5) + 5  # synch, four bytes of the device
        self.address = data[at]
        self.memory = np.zeros(24 * 32, int)
        at += 2
        while True:
            head, bank, count = data[at : at + 3]
            count = count or 256
            assert data[at + 3 + count] == 0x2A
            start = 32 * bank + (head & 31)
            self.memory[start : start + count] = data[at + 3 : at + 3 + count]
            at += 4 + count
            if not head & 0x40:
                break

    def at(self, bank, byte):
        return int(self.memory[32 * bank + byte])

    def period(self, nibble):
        """ACLK ticks of the clock that a CAB's nibble names."""
        clock = {0xC: 7, 0xD: 6, 0xE: 5, 0xF: 4, 0xA: 3, 0xB: 1}[nibble]
        divisor = lambda byte: 2 * byte or 1
        assert self.at(0, 9) == self.at(0, 10)
        return divisor(self.at(0, 9)) * divisor(self.at(0, clock))


ROUTES = {1: (7, 4), 2: (7, 0), 3: (3, 4), 4: (3, 0), 5: (6, 4), 6: (6, 0), 7: (2, 4)}  # of a cell: byte and shift, odd column
MODES = {1: 0x13, 2: 0x10, 3: 0x0D, 4: 0x0A, 5: 0x16, 6: 0x15, 7: 0x14}
SAMPLED = {1: 0x12, 2: 0x0F, 3: 0x0C, 4: 0x09}
BESIDE = {1: 1, 2: 1, 3: 3, 4: 3, 5: 1, 6: 1, 7: 3}  # CAB of the odd column
# Selectors 9/8, B/A, D/C, F/E of CAB 1 to 4: the CAB whose op-amps they read; 0: its direct lines.
SELECTED = {1: (0, 3, 4, 2), 2: (0, 1, 3, 4), 3: (2, 1, 0, 4), 4: (2, 1, 3, 0)}
WORDS = {1: (1, 0x1C), 2: (0, 0x1C), 3: (1, 0x16), 4: (0, 0x18), 5: (1, 0x10), 6: (0, 0x14), 7: (1, 0x0C), 8: (0, 0x10)}


class Board:
    """Chips and the wires from output cell to input cell, ((chip, cell), (chip, cell)), outside them."""

    def __init__(self, chips, wires, source, sink, master_hz=16e6):
        self.chips = {chip.address: chip for chip in chips}
        self.feeds = {end: start for start, end in wires}
        self.source = source
        self.master_hz = master_hz
        self.held = []  # (node, period, phase) of sampling cells, each a node of its own behind the op-amps
        self.count = 8 * len(chips)
        self.first = {address: 8 * i for i, address in enumerate(sorted(self.chips))}
        self.capacitors = []  # units, near and far in phase 1 and 2, period
        self.cabs = []  # of each: its chip's address and CAB
        self.resets = []  # op-amp, phase, period
        for chip in chips:
            for cab in range(1, 5):
                self.read_cab(chip, cab)
        self.output = self.cell_driver(sink)

    def read_cab(self, chip, cab):
        bank_a, bank_b = 2 * cab + 1, 2 * cab + 2
        clocks = {1: chip.at(bank_b, 0) & 15, 2: chip.at(bank_b, 0) >> 4}
        for number, byte in ((1, 0x1A), (2, 0x14)):
            word = chip.at(bank_b, byte)
            if word & 0xC0:
                opamp = self.first[chip.address] + 2 * (cab - 1) + number - 1
                self.resets.append((opamp, 0 if word & 0x40 else 1, chip.period(clocks[word & 3])))
        for c in range(1, 9):
            units = chip.at(bank_a, 8 - c)
            if not units:
                continue
            bank, byte = (bank_b if WORDS[c][0] else bank_a), WORDS[c][1]
            plates, period = [], 0  # static
            for word in (byte, byte + 2):
                clock, nodes = chip.at(bank, word), chip.at(bank, word + 1)
                assert clock in (0, 1, 2)
                if clock:
                    period = chip.period(clocks[clock])
                plates.append((nodes & 15 if clock else nodes >> 4, nodes >> 4))
            near = tuple(self.near(chip, cab, s) for s in plates[0])
            far = tuple({0: KEEP, 8: GROUND}.get(s, self.first[chip.address] + 2 * (cab - 1) + s - 1) for s in plates[1])
            self.capacitors.append((units, near, far, period))
            self.cabs.append((chip.address, cab))

    def opamp(self, chip, cab, number):
        return self.first[chip.address] + 2 * (cab - 1) + number - 1

    def nibble(self, chip, cell, even):
        byte, shift = ROUTES[cell]
        return chip.at(2, byte - 2 * even) >> shift & 15

    def near(self, chip, cab, selector):
        if selector in (0, 1):
            return (KEEP, GROUND)[selector]
        if selector in (2, 3):
            return self.opamp(chip, cab, 1 if selector == 3 else 2)
        even = cab % 2 == 0
        if selector in (6, 7):
            line = chip.at(2 * cab + 2, 5 if selector == 7 else 4)
            return self.line_driver(chip, even, line)
        assert selector >= 8
        other = SELECTED[cab][(selector - 8) // 2]
        number = 1 if selector % 2 else 2
        if other:
            return self.opamp(chip, other, number)
        for cell in MODES:
            if chip.at(2, MODES[cell]) and BESIDE[cell] + even == cab and self.nibble(chip, cell, even) == number:
                return self.pin((chip.address, cell))
        raise AssertionError("a direct line without an input cell")

    def line_driver(self, chip, even, line):
        for cab in (2, 4) if even else (1, 3):
            drives = chip.at(2 * cab + 2, 2)
            for number, bit in ((1, 0x01), (2, 0x02)):
                if drives & bit << (3 * (line - 1)):
                    return self.opamp(chip, cab, number)
        for cell, mode in MODES.items():
            if chip.at(2, mode) in (0x40, 0x08) and self.nibble(chip, cell, even) == 4 + line:
                return self.pin((chip.address, cell))
        raise AssertionError("a column line without a driver")

    def pin(self, cell):
        if cell in self.feeds:
            start = self.feeds[cell]
            return self.pin(start) if start in self.feeds else self.cell_driver(start)
        assert cell == self.source
        return INPUT

    def cell_driver(self, cell):
        chip, number = self.chips[cell[0]], cell[1]
        mode = chip.at(2, MODES[number])
        if mode == 0x40:
            return self.pin(cell)
        node = None
        for even in (False, True):
            nibble = self.nibble(chip, number, even)
            if nibble in (0xC, 8):
                node = self.opamp(chip, BESIDE[number] + even, 1 if nibble == 0xC else 2)
            elif nibble in (5, 6):
                node = self.line_driver(chip, even, nibble - 4)
        if mode != 3:
            assert mode in (0x10, 8)
            return node
        option = chip.at(2, SAMPLED[number])
        own = self.count + len(self.held)
        self.held.append((node, chip.period(0xC + (option - 0x42) // 8), 0 if option & 4 else 1))
        return own

    def step(self, closed):
        """Voltages V = f x + g u and what is carried on, x' = m x + n u, while each clock stands in a phase."""
        caps, opamps = len(self.capacitors), self.count
        held, nodes = len(self.held), opamps + len(self.held)
        a, f, g = np.zeros((nodes, nodes)), np.zeros((nodes, caps + held)), np.zeros(nodes)
        for k, (units, near, far, period) in enumerate(self.capacitors):
            n, to = near[closed[period]], far[closed[period]]
            if to < 0 or n == KEEP:
                continue
            f[to, k] += units
            if n >= 0:
                a[to, n] += units
            elif n == INPUT:
                g[to] -= units
        for opamp, phase, period in self.resets:
            if closed[period] == phase:
                a[opamp], f[opamp], g[opamp] = 0.0, 0.0, 0.0
                a[opamp, opamp] = 1.0
        for k, (node, period, phase) in enumerate(self.held):
            a[opamps + k, opamps + k] = 1.0
            if closed[period] == phase:
                a[opamps + k, node] -= 1.0
            else:
                f[opamps + k, caps + k] = 1.0
        for row in range(opamps):
            if not a[row].any():
                a[row, row] = 1.0
        f, g = np.linalg.solve(a, f), np.linalg.solve(a, g)
        m, n = np.zeros((caps + held, caps + held)), np.zeros(caps + held)
        for k, (units, near, far, period) in enumerate(self.capacitors):
            from_node = near[closed[period]]
            if from_node == KEEP or far[closed[period]] == KEEP:
                m[k, k] = 1.0
            elif from_node >= 0:
                m[k], n[k] = f[from_node], g[from_node]
            elif from_node == INPUT:
                n[k] = 1.0
        for k in range(held):
            m[caps + k], n[caps + k] = f[opamps + k], g[opamps + k]
        return f, g, m, n

    def gain(self, hz):
        """Component of the output at each sine's own frequency."""
        if self.output == INPUT:
            return np.ones(len(hz), complex)
        periods = ({c[3] for c in self.capacitors} | {r[2] for r in self.resets} | {h[1] for h in self.held}) - {0}
        common = math.lcm(*(2 * p for p in periods))  # half ACLK ticks
        edges = sorted({t for p in periods for t in range(0, common, p)} | {common})
        assert len(edges) < 20000, f"{len(edges)} switching instants"
        w = 2 * np.pi * np.asarray(hz)
        seconds = 0.5 / self.master_hz
        known, steps = {}, []
        for t in edges[:-1]:
            closed = {p: 0 if t % (2 * p) < p else 1 for p in periods} | {0: 0}
            key = tuple(closed.values())
            if key not in known:
                known[key] = self.step(closed)
            steps.append(known[key])
        states = len(self.capacitors) + len(self.held)
        turn = [np.exp(1j * w * t * seconds) for t in edges]
        whole, x = np.eye(states), np.zeros((states, len(w)), complex)
        for (f, g, m, n), end in zip(steps, turn[1:]):
            whole, x = m @ whole, m @ x + np.outer(n, end)
        start = np.stack([np.linalg.solve(turn[-1][i] * np.eye(states) - whole, x[:, i]) for i in range(len(w))], axis=1)
        out, x = np.zeros(len(w), complex), start
        for i, (f, g, m, n) in enumerate(steps):
            alpha = f[self.output] @ x
            # int alpha exp(-jwt) dt over the interval, and of beta exp(jwt) exp(-jwt).
            out += alpha * (np.conj(turn[i]) - np.conj(turn[i + 1])) / (1j * w)
            out += g[self.output] * (edges[i + 1] - edges[i]) * seconds
            x = m @ x + np.outer(n, turn[i + 1])
        return out / (common * seconds)


def board_of(plan, folder):
    """The chips of `folder`'s streams with the pins and outside wires that plan.json names."""
    pins = {f"chip{c['chip']}.{pin}": (c["chip"], int(cell[2:])) for c in plan["chips"] for pin, cell in c["pins"].items()}
    chips = [Chip((folder / f"chip{c['chip']}.ahf").read_text()) for c in plan["chips"]]
    ends = [(w["from"], w["to"]) for w in plan["wires"]]
    wires = [(pins[a], pins[b]) for a, b in ends if a in pins and b in pins and ".in" in b]
    source = next(a for a, _ in ends if ".in" in a and all(b != a for _, b in ends))
    sink = next(b for _, b in ends if ".out" in b and all(a != b for a, _ in ends))
    return Board(chips, wires, pins[source], pins[sink])


def sections_response(sections, hz):
    """H(jw) of sections.json, and what an error is relative to: |H| with zeros damped by at least .02."""
    s = 2j * np.pi * np.asarray(hz)
    h, size = sections["gain"] * np.ones(len(s), complex), np.abs(sections["gain"]) * np.ones(len(s))
    for section in sections["sections"]:
        h, size = h * section["gain"], size * abs(section["gain"])
        for re, im in section["zeros_rad_s"]:
            zero = complex(re, im)
            h, size = h * (s - zero), size * np.maximum(np.abs(s - zero), 0.02 * abs(zero))
        for re, im in section["poles_rad_s"]:
            h, size = h / (s - complex(re, im)), size / np.abs(s - complex(re, im))
    return h, size
