"""Tests of the program from outside: what shells, editors, terminals and packages see of it."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("BODESMITH_PROGRAM", str(ROOT / "build/bin/bodesmith"))


class Result:
    def __init__(self, done):
        self.status = done.returncode
        self.out = done.stdout
        self.err = done.stderr


def run(*arguments, cwd=None, env=None, text_in=None):
    """Runs bodesmith; its status, what it said, and what it complained of."""
    environment = dict(os.environ)
    environment.update(env or {})
    return Result(
        subprocess.run(
            [PROGRAM, *map(str, arguments)],
            cwd=cwd,
            env=environment,
            input=text_in or "",
            capture_output=True,
            text=True,
            timeout=120,
        )
    )


@pytest.fixture(scope="session")
def help_texts():
    """--help of every subcommand and of those below them, by name ("fpaa streams")."""
    import re

    names = re.findall(r"^  ([a-z]+) +\S", run("--help").out.split("Subcommands")[1], re.M)
    names += ["fpaa " + verb for verb in ("streams", "verify", "check", "controller", "gains", "disassemble", "trim", "send")]
    names.append("yield controller")
    return {name: run(*name.split(), "--help").out for name in names}


def options_in(help_text):
    """The long options that a --help shows."""
    import re

    return set(re.findall(r"^  (?:-\w \[ )?--([a-z0-9-]+)", help_text, re.M))
