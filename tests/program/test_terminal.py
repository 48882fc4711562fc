"""Progress, colours, --quiet and suggestions, at a terminal (a pseudo-terminal) and away from one."""

import os
import pty
import re
import select
import signal
import time

import pytest
from conftest import PROGRAM, ROOT, run

MODEL = ROOT / "examples/piezo_loop/stage.toml"


class Terminal:
    """The program with stdin, stdout and stderr on a pseudo-terminal."""

    def __init__(self, *arguments, cwd=None, env=None):
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            environment = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
            environment.update({"TERM": "xterm"}, **(env or {}))
            if cwd is not None:
                os.chdir(cwd)
            os.execve(PROGRAM, [PROGRAM, *map(str, arguments)], environment)
        self.text = ""
        self.status = None

    def read(self, seconds):
        """More of what it said; False at its end."""
        if not select.select([self.fd], [], [], seconds)[0]:
            return True
        try:
            piece = os.read(self.fd, 65536)
        except OSError:  # Linux says so when the other side has gone
            piece = b""
        self.text += piece.decode("utf-8", "replace")
        return piece != b""

    def wait_for(self, pattern, seconds=60):
        end = time.monotonic() + seconds
        while not re.search(pattern, self.text):
            if not self.read(0.2) or time.monotonic() > end:
                pytest.fail(f"no {pattern!r} in {self.text[-2000:]!r}")

    def send(self, text):
        os.write(self.fd, text.encode())

    def finish(self, seconds=60):
        end = time.monotonic() + seconds
        while self.read(0.2):
            if time.monotonic() > end:
                os.kill(self.pid, signal.SIGKILL)
                break
        self.status = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        os.close(self.fd)
        return self.text


def long_record(folder, samples):
    """A sawtooth on which an ODE solver works for very long."""
    record = folder / "u.csv"
    record.write_text("time_s,u\n" + "".join(f"{i * 1e-4:.4f},{i % 7 / 7}\n" for i in range(samples)))
    return record


LONG = ["--engine", "cvode", "--tolerance", "1e-11", "-o"]


def test_a_single_simulation_shows_a_bar_and_the_time_left(tmp_path):
    record = long_record(tmp_path, 400_000)
    seen = Terminal("simulate", MODEL, "--input", record, *LONG, tmp_path / "y.csv")
    seen.wait_for(r"\r\x1b\[K\[#+-*\] +\d+ %  simulate: simulation.*, \d+ (s|min) left")
    seen.send("\x03")
    text = seen.finish()
    assert seen.status == 130
    # The line is taken back before anything else is said.
    assert re.search(r"\r\x1b\[K\S*bodesmith:\S* interrupted", text), text[-300:]
    assert not (tmp_path / "y.csv").exists()


def test_no_bar_where_there_is_no_terminal_and_none_with_quiet(tmp_path):
    samples = ["--reference", "triangle", "--frequency-hz", "10", "-o", tmp_path / "y.csv"]
    piped = run("simulate", MODEL, *samples)
    assert piped.status == 0 and "\x1b" not in piped.out + piped.err and "\r" not in piped.err
    quiet = run("simulate", MODEL, *samples, "--quiet")
    assert (quiet.status, quiet.out, quiet.err) == (0, "", "")
    as_json = run("simulate", MODEL, *samples, "--quiet", "--json")
    assert as_json.out.startswith("{") and as_json.err == ""
    # Errors are said all the same.
    failed = run("simulate", MODEL, "--input", tmp_path / "none.csv", "-o", tmp_path / "z.csv", "--quiet")
    assert failed.status == 2 and failed.err.startswith("bodesmith: ")


def test_quiet_shows_no_bar_at_a_terminal(tmp_path):
    record = long_record(tmp_path, 60_000)
    seen = Terminal("simulate", MODEL, "--input", record, *LONG, tmp_path / "y.csv", "--quiet")
    # To its end, which takes long enough for a bar: how fast a machine is decides nothing.
    assert (seen.finish(seconds=600), seen.status) == ("", 0)


@pytest.mark.parametrize(
    "env, coloured", [({}, True), ({"NO_COLOR": "1"}, False), ({"NO_COLOR": ""}, True), ({"TERM": "dumb"}, False)]
)
def test_colours_only_where_they_are_wanted(env, coloured):
    seen = Terminal("simulate", env=env)
    text = seen.finish()
    assert seen.status == 2 and "MODEL.toml|SECTIONS.json is missing" in text
    assert ("\x1b[1;31mbodesmith:" in text) == coloured
    assert "\x1b" not in run("simulate").err


def test_a_missed_limit_stands_out_at_a_terminal(tmp_path):
    points = ROOT / "examples/riaa/points.csv"
    words = ["fit", points, "--direct", "--order", "1", "--max-error-db", "0.001", "-o", tmp_path / "s.json"]
    seen = Terminal(*words)
    text = seen.finish()
    assert seen.status == 1 and "\x1b[1;31mNOT met\x1b[0m" in text
    assert "NOT met" in run(*words).out and "\x1b" not in run(*words).out


SLIPS = [
    (["simulte", "m.toml"], "did you mean 'simulate'?"),
    (["--vresion"], "did you mean '--version'?"),
    (["fit", "p.csv", "--oder", "3", "-o", "x"], "did you mean '--order'?"),
    (["simulate", "m.toml", "--oversampel", "3", "-o", "x"], "did you mean '--oversample'?"),
    (["simulate", str(MODEL), "--engine", "exakt", "-o", "x"], "did you mean 'exact'?"),
    (["approximate", "cascade.json", "--method", "oustalop", "--order", "3", "-o", "x"], "did you mean 'oustaloup'?"),
    (["design", "lowpass", "--family", "butter", "--order", "3", "--corner-hz", "1k", "-o", "x"], "did you mean 'butterworth'?"),
    (["identify", "r.csv", "--model", "prandtl_ishlinsky", "-o", "x"], "did you mean 'prandtl_ishlinskii'?"),
    (["simulate", "type.toml", "--input", "u.csv", "-o", "x"], "type.toml:3: 'block[0].type' is 'lowpas' (did you mean 'lowpass'?)"),
    (["simulate", "key.toml", "--input", "u.csv", "-o", "x"], "(did you mean 'corner_hz'?)"),
    (["identify", "columns.csv", "--model", "linear", "-o", "x"], "columns.csv:1: has no column 'time_s', found: times, u, y (did you mean it by 'times'?)"),
    (["run", "project.toml", "-o", "x"], "'limit' is not known here (did you mean 'limits'?)"),
    (["schema", "projet"], "did you mean 'project'?"),
    (["new", "d", "--kind", "filtr"], "did you mean 'filter'?"),
    (["completion", "bsh"], "did you mean 'bash'?"),
]


@pytest.fixture(scope="module")
def slips(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slips")
    block = 'schema = "bodesmith.model/1"\n[[block]]\ntype = "{}"\n{} = 10\n'
    (folder / "type.toml").write_text(block.format("lowpas", "corner_hz"))
    (folder / "key.toml").write_text(block.format("lowpass", "corner_h"))
    (folder / "u.csv").write_text("time_s,u\n0,0\n1,1\n")
    (folder / "columns.csv").write_text("times,u,y\n0,0,0\n1,1,1\n2,2,2\n")
    (folder / "r.csv").write_text("time_s,u,y\n" + "".join(f"{i},{i % 5},{i % 5}\n" for i in range(50)))
    (folder / "cascade.json").write_text('{"schema":"bodesmith.cascade/1","terms":[{"lambda_s":1,"x":0.5,"beta":0.5}]}')
    (folder / "p.csv").write_text("frequency_hz,gain\n1,1\n10,2\n")
    (folder / "project.toml").write_text('schema = "bodesmith.project/1"\n[target]\npoints = "p.csv"\n[limit]\npoints_db = 1\n')
    return folder


@pytest.mark.parametrize("words, hint", SLIPS, ids=lambda value: "_".join(value[:2]) if isinstance(value, list) else "")
def test_slips_get_a_suggestion(slips, words, hint):
    said = run(*words, cwd=slips)
    assert said.status == 2, said.out
    assert hint in said.err, said.err
    assert said.err.count("\n") == 1


def test_no_suggestion_where_nothing_is_near(slips):
    for words in (["zzz"], ["fit", "p.csv", "--qqqqq", "-o", "x"], ["approximate", "cascade.json", "--method", "none", "-o", "x"]):
        said = run(*words, cwd=slips)
        assert said.status == 2 and "did you mean" not in said.err, said.err
