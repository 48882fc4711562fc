"""Long work: Ctrl-C, progress, other threads."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time

import pytest

import bodesmith as bs

SECTIONS = bs.design("lowpass", order=4, corner_hz=1000.0)

CHILD = """
import signal, bodesmith as bs
signal.signal(signal.SIGINT, signal.default_int_handler)  # whatever started the tests may ignore it
sections = bs.design("lowpass", order=4, corner_hz=1000.0)
def say(fraction):
    print("begun", flush=True)
try:
    bs.yield_(sections, samples=10**10, progress=say)
except KeyboardInterrupt:
    print("interrupted", flush=True)
print(bs.yield_(sections, samples=100).designs[0]["samples"], flush=True)
"""


def test_ctrl_c_ends_the_work_and_not_the_program():
    child = subprocess.Popen([sys.executable, "-c", CHILD], stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout.readline() == "begun\n"
        child.send_signal(signal.SIGINT)
        said, _ = child.communicate(timeout=300)
    finally:
        child.kill()
    lines = [line for line in said.splitlines() if line != "begun"]
    assert lines == ["interrupted", "100"]
    assert child.returncode == 0


def test_what_the_callback_raises_ends_the_work():
    class Enough(Exception):
        pass

    def stop(fraction):
        raise Enough

    with pytest.raises(Enough):
        bs.yield_(SECTIONS, samples=10**10, progress=stop)
    assert bs.yield_(SECTIONS, samples=100).designs[0]["samples"] == 100


def test_other_threads_go_on():
    count = 0
    done = threading.Event()

    def work():
        try:
            bs.yield_(SECTIONS, samples=200_000, count=40, threads=1)
        finally:
            done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.wait(0.001):
        count += 1
    thread.join()
    assert count > 3  # without the lock given back this loop would not turn before the work is done


def test_signals_are_left_as_they_were():
    before = signal.getsignal(signal.SIGINT)
    bs.simulate(bs.Model([{"type": "gain", "gain": 1.0}]), [0.0, 1.0], step_s=1.0)
    assert signal.getsignal(signal.SIGINT) is before
