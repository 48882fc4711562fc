#!/usr/bin/env python3
"""Sends the capacitors of the branch gains to the board when the frequency changes. Made from {{file}}.

  gain_host.py /dev/ttyUSB0                  frequencies in Hz on standard input, one a line
  gain_host.py /dev/ttyUSB0 --samples 10000  samples of the reference, one a line, so many a second: the frequency is
                                             measured from one rise through the middle to the next
  gain_host.py - ...                         sends nothing, shows which set it would take

The line is 57600 baud, 8 bits, no parity. After each packet the board is asked for its status; a packet that is not
answered is sent again. As a module: GainHost(Line(device)).follow(frequency_hz).
"""
import math
import os
import select
import sys
import termios
import tty

# frequency_hz, to_hz, keep_from_hz, keep_to_hz, update stream of each chip. A set serves up to to_hz; once taken it is
# kept from keep_from_hz to keep_to_hz, so that it does not toggle.
SETS = [
{{#sets}}
    #{{#gains}} {{branch}} {{over}}/{{under}} = {{gain}}{{/gains}}
    ({{frequency}}, {{to}}, {{keep_from}}, {{keep_to}}, [
{{#packets}}
        "{{hex}}",
{{/packets}}
    ]),
{{/sets}}
]
TRIES = 4
ANSWER_S = 1.0


class Line:
    """The board's serial line."""

    def __init__(self, device):
        self.file = os.open(device, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.file)
        attributes = termios.tcgetattr(self.file)
        attributes[2] |= termios.CLOCAL | termios.CREAD
        attributes[2] &= ~(termios.CSTOPB | termios.PARENB)
        attributes[4] = attributes[5] = termios.B57600
        termios.tcsetattr(self.file, termios.TCSANOW, attributes)
        termios.tcflush(self.file, termios.TCIOFLUSH)

    def put(self, data):
        while data:
            data = data[os.write(self.file, data):]

    def get(self, seconds):
        ready, _, _ = select.select([self.file], [], [], seconds)
        return os.read(self.file, 1) if ready else b""

    def good_answer(self):
        """An answer ends with a 0 byte."""
        answer = b""
        while len(answer) < 256:
            byte = self.get(ANSWER_S)
            if not byte:
                return False
            if byte in b"\x11\x13" or (byte == b"\0" and not answer):
                continue
            if byte == b"\0":
                return b"ERR" not in answer and b"FAIL" not in answer
            if byte[0] > 0x7E:
                return False
            answer += byte
        return False

    def send_update(self, text):
        """STX, '1' for an update, four digits with the number of hexadecimal characters, the text, ETX; then '?'."""
        packet = b"\x021" + format(len(text), "04X").encode() + text.encode() + b"\x03"
        for _ in range(TRIES):
            while self.get(0.01):
                pass
            self.put(packet)
            self.put(b"\x02?")
            good = self.good_answer()
            self.put(b"\x03")
            if good:
                return
        raise TimeoutError("the board does not answer after an update (%d tries)" % TRIES)


def set_for(frequency_hz):
    return next((i for i, one in enumerate(SETS[:-1]) if frequency_hz < one[1]), len(SETS) - 1)


class GainHost:
    """Keeps the board's gains at the set that serves the frequency; without a line it only says which."""

    def __init__(self, line=None):
        self.line = line
        self.current = None

    def follow(self, frequency_hz):
        """True when another set was sent."""
        if self.current is not None:
            _, _, keep_from, keep_to, _ = SETS[self.current]
            if keep_from <= frequency_hz <= keep_to:
                return False
        wanted = set_for(frequency_hz)
        if wanted == self.current:
            return False
        if self.line is not None:
            for text in SETS[wanted][4]:
                self.line.send_update(text)
        self.current = wanted
        return True


class PeriodMeter:
    """The frequency from samples: from one rise through 60 % of the last period's span to the next, after a fall below
    40 %. It assumes one rise a period: of a sum of tones it finds the period of the largest."""

    def __init__(self, rate_hz):
        self.step = 1.0 / rate_hz
        self.count = 0
        self.restart(0.0)

    def restart(self, x):
        self.low = self.high = self.next_low = self.next_high = self.last = x
        self.crossings = 0
        self.period = 0.0
        self.crossed = 0.0
        self.armed = False

    def take(self, x):
        """The frequency when a period has just ended, otherwise None."""
        time = self.step * self.count
        if self.count == 0:
            self.restart(x)
        self.count += 1
        self.next_low, self.next_high = min(self.next_low, x), max(self.next_high, x)
        if self.crossings == 0:
            self.low, self.high = min(self.low, x), max(self.high, x)
        span = self.high - self.low
        upper = self.low + 0.6 * span
        self.armed = self.armed or x < self.low + 0.4 * span
        out = None
        if self.armed and self.last < upper <= x:
            at = time - self.step * (x - upper) / (x - self.last)
            if self.crossings > 0:
                self.period = at - self.crossed
                if self.period > 0.0:
                    out = 1.0 / self.period
                self.low, self.high = self.next_low, self.next_high
            self.crossings += 1
            self.next_low = self.next_high = x
            self.crossed = at
            self.armed = False
        elif self.period > 0.0 and time - self.crossed > 4.0 * self.period:
            self.restart(x)  # the amplitude has fallen, or the reference rests: the span is learnt anew
        self.last = x
        return out


def main(arguments):
    if len(arguments) not in (1, 3) or (len(arguments) == 3 and arguments[1] != "--samples"):
        print("usage: gain_host.py DEVICE|- [--samples PER_SECOND] < numbers", file=sys.stderr)
        return 2
    number = 0
    try:
        meter = PeriodMeter(float(arguments[2])) if len(arguments) == 3 else None
        host = GainHost(None if arguments[0] == "-" else Line(arguments[0]))
        for number, text in enumerate(sys.stdin, 1):
            if not text.strip() or text.startswith("#"):
                continue
            frequency = float(text)
            if not math.isfinite(frequency) or (meter is None and frequency <= 0.0):
                raise ValueError("expected a frequency above 0 Hz")
            if meter is not None:
                frequency = meter.take(frequency)
            if frequency is not None and host.follow(frequency):
                print("%.6g Hz: set %d (%.6g Hz)" % (frequency, host.current, SETS[host.current][0]), flush=True)
    except TimeoutError as error:
        print("gain_host.py: line %d: %s" % (number, error), file=sys.stderr)
        return 1
    except (OSError, ValueError, ZeroDivisionError, termios.error) as error:
        print("gain_host.py: line %d: %s" % (number, error), file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
