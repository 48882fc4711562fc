"""Kills subcommands at random instants and looks at what is left.

    python3 tests/kill/kill_at_random.py build/bin/bodesmith [--count 200] [--seed 1] [COMMAND...]

Every command runs on small inputs, once in peace (the reference), then --count times until a signal (SIGINT, SIGTERM and
SIGKILL in turn) at an instant drawn between its start and a little after its end, into a folder that is empty or holds
an older result. After each: every file is whole, nothing temporary stands in the output folder or in TMPDIR (after
SIGKILL it may, until the next run), no ngspice lives on, the exit status tells the truth. Every tenth time, and always
after something temporary stayed, the command runs again to its end: the same bytes as the reference (--resume where
the command has it).
"""

import argparse
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
TIMING = re.compile(r'"(timing_s|wall_s|ngspice_s|compute|seconds)": *(\{[^}]*\}|[-+.0-9e]+)')

SECTIONS = {
    "schema": "bodesmith.sections/1",
    "gain": 1,
    "sections": [
        {"gain": 2, "zeros_rad_s": [[-30000, 0]], "poles_rad_s": [[-10000, 0]]},
        {"gain": 1, "zeros_rad_s": [[-40000, 0]], "poles_rad_s": [[-90000, 0]]},
    ],
}
MODEL = """schema = "bodesmith.model/1"
[[block]]
type = "gain"
gain = 2.0
offset = 0.0
[[block]]
type = "lowpass"
corner_hz = 3.0
"""
PROJECT = """schema = "bodesmith.project/1"
[target]
sections = "sections.json"
from_hz = 500.0
to_hz = 50000.0
[hardware.circuit]
"""


def make_inputs(folder):
    folder.mkdir()
    (folder / "sections.json").write_text(json.dumps(SECTIONS))
    (folder / "model.toml").write_text(MODEL)
    (folder / "project.toml").write_text(PROJECT)
    rows, state = ["time_s,u,y"], 0.0
    for i in range(600):
        u = ((i * 7919) % 100) / 100 + (i // 50) % 3
        state += 0.18 * (2.0 * u - state)
        rows.append(f"{i * 0.01:.2f},{u:.4f},{state + 0.3 * state * state:.6g}")
    (folder / "train.csv").write_text("\n".join(rows[:401]) + "\n")
    (folder / "holdout.csv").write_text("\n".join(rows) + "\n")


# name: arguments, whether what SIGINT leaves is a result of its own, and the option that takes work up again.
COMMANDS = {
    "run": (["run", "project.toml", "-o", "OUT"], False, []),
    "diagnose": (["diagnose", "model.toml", "--data", "train.csv", "--holdout", "holdout.csv", "--max-terms", "1",
                  "-o", "OUT"], True, []),
    "yield": (["yield", "sections.json", "--samples", "300000", "--count", "3", "--seed", "3", "-o",
               "OUT/yield.json"], False, []),
    "spice": (["spice", "sections.json", "--check", "-o", "OUT"], False, []),
    "fpaa": (["fpaa", "sections.json", "-o", "OUT"], False, []),
    "sweep": (["simulate", "model.toml", "--reference", "sine", "--engine", "cvode", "--sweep-frequency-hz", "1,2,3,4,5,6,7,8",
               "-o", "OUT/sweep.csv"], True, ["--resume"]),
}


def contents(folder):
    out = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            out[str(path.relative_to(folder))] = TIMING.sub('"time": 0', path.read_bytes().decode("utf-8", "replace"))
    return out


def is_temporary(name):
    return re.search(r"(^|/)\.[^/]*\.tmp\d+$", name) is not None


def is_whole(name, text):
    """Of a result that the reference does not have: does the file end as such a file ends?"""
    if name.endswith(".json"):
        try:
            json.loads(text)
        except ValueError:
            return False
        return True
    if name.endswith(".html"):
        return text.rstrip().endswith("</html>")
    if name.endswith(".svg"):
        return text.rstrip().endswith("</svg>")
    return text.endswith("\n")


class Killer:
    def __init__(self, program, name, work, chance):
        arguments, self.own_result, self.resume = COMMANDS[name]
        self.program, self.name, self.chance = program, name, chance
        self.inputs, self.out, self.tmp = work / "in", work / "out", work / "tmp"
        self.arguments = [str(self.out) + a[3:] if a.startswith("OUT") else a for a in arguments]
        self.tmp.mkdir(exist_ok=True)
        self.environment = {**os.environ, "TMPDIR": str(self.tmp)}
        self.faults = []
        begin = time.monotonic()
        self.clear()
        done = subprocess.run([program, *self.arguments], cwd=self.inputs, env=self.environment, capture_output=True)
        self.seconds = time.monotonic() - begin
        if done.returncode not in (0, 1):
            sys.exit(f"{name}: ended with {done.returncode}: {done.stderr.decode()}")
        self.status = done.returncode
        self.reference = contents(self.out)
        self.kept = work / "kept"
        shutil.rmtree(self.kept, ignore_errors=True)
        shutil.copytree(self.out, self.kept)

    def clear(self):
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.mkdir()

    def fault(self, text):
        self.faults.append(text)
        print(f"{self.name}: {text}", file=sys.stderr)

    def survivors(self):
        out = []
        for place in pathlib.Path("/proc").iterdir():
            try:
                if place.name.isdigit() and os.readlink(place / "cwd").startswith(str(self.tmp)):
                    out.append(place.name)
            except OSError:
                pass
        return out

    def once(self, which, full):
        self.clear()
        if full:
            shutil.rmtree(self.out)
            shutil.copytree(self.kept, self.out)
        delay = self.chance.uniform(0.0, 1.1 * self.seconds)
        where = f"{which.name} after {delay:.3f} s, {'old result there' if full else 'empty folder'}"
        process = subprocess.Popen([self.program, *self.arguments], cwd=self.inputs, env=self.environment,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        time.sleep(delay)
        process.send_signal(which)
        try:
            said = process.communicate(timeout=90)[1].decode("utf-8", "replace")
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            self.fault(f"{where}: still running 90 s later")
            return
        ended = process.returncode
        allowed = {signal.SIGINT: (130, -signal.SIGINT), signal.SIGTERM: (143, -signal.SIGTERM),
                   signal.SIGKILL: (-signal.SIGKILL,)}[which]
        if ended not in (*allowed, self.status):
            self.fault(f"{where}: exit status {ended}: {said[-300:]}")
        found = contents(self.out)
        stale = [n for n in found if is_temporary(n)]
        for name, text in found.items():
            if is_temporary(name) or ".checkpoint" in name or name == "UNFINISHED.txt":
                continue
            if text != self.reference.get(name) and not (self.own_result and is_whole(name, text)):
                self.fault(f"{where}: {name} is not the reference's")
        if not full and ended in allowed and not self.own_result and "UNFINISHED.txt" not in found:
            some = [n for n in found if n in self.reference]
            if some and len(some) < len(self.reference):
                # Files are renamed one after the other: only SIGKILL and SIGTERM may come between.
                if which == signal.SIGINT:
                    self.fault(f"{where}: {len(some)} of {len(self.reference)} files and nothing says so")
        time.sleep(0.02)
        left = [str(p) for p in self.tmp.iterdir()]
        if which != signal.SIGKILL and (stale or left):
            self.fault(f"{where}: left {stale + left}")
        # A child whose parent was killed dies when the machine next runs it; any other end waits for its children.
        until = time.monotonic() + (10.0 if which == signal.SIGKILL else 0.0)
        while self.survivors() and time.monotonic() < until:
            time.sleep(0.05)
        if self.survivors():
            self.fault(f"{where}: processes {self.survivors()} live on")
        shutil.rmtree(self.tmp)
        self.tmp.mkdir()
        return bool(stale)

    def again(self):
        done = subprocess.run([self.program, *self.arguments, *self.resume], cwd=self.inputs, env=self.environment,
                              capture_output=True)
        found = contents(self.out)
        if done.returncode != self.status or found != self.reference:
            differing = [n for n in {*found, *self.reference} if found.get(n) != self.reference.get(n)]
            self.fault(f"run again: exit status {done.returncode}, {sorted(differing)} differ: {done.stderr.decode()[-300:]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("commands", nargs="*", help=", ".join(COMMANDS))
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    faults = 0
    for name in asked.commands or COMMANDS:
        with tempfile.TemporaryDirectory(prefix="bodesmith-kill-") as folder:
            work = pathlib.Path(folder)
            make_inputs(work / "in")
            killer = Killer(str(asked.program.resolve()), name, work, random.Random(asked.seed))
            rerun = 0
            for i in range(asked.count):
                which = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)[i % 3]
                if killer.once(which, full=(i // 3) % 2 == 1) or i % 10 == 9 or i + 1 == asked.count:
                    killer.again()
                    rerun += 1
            print(f"{name}: {asked.count} kills, {rerun} runs to the end, {killer.seconds:.2f} s alone, "
                  f"{len(killer.faults)} faults", flush=True)
            faults += len(killer.faults)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
