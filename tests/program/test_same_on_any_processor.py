"""What a search ends at does not depend on the processor: glibc told that there are no fused multiply-adds chooses other variants of
exp, log, sin and pow, whose last bits differ."""

import json

import pytest
from conftest import ROOT, run

# Any x86-64 before 2013, as far as glibc's functions go.
PLAIN = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-AVX,-FMA,-FMA4"}
EXAMPLES = ROOT / "examples"


def without_times(folder):
    """Every file of a folder by name; seconds left out."""

    def plain(value):
        if isinstance(value, dict):
            return {key: plain(v) for key, v in value.items() if key != "timing_s"}
        return [plain(v) for v in value] if isinstance(value, list) else value

    files = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            files[str(path.relative_to(folder))] = plain(json.loads(path.read_text())) if path.suffix == ".json" else path.read_bytes()
    return files


def both_ways(tmp_path, *arguments):
    for name, env in (("here", {}), ("plain", PLAIN)):
        (tmp_path / name).mkdir()
        made = run(*arguments, "-o", "out", cwd=tmp_path / name, env=env)
        assert made.status == 0, made.err
    here, plain = without_times(tmp_path / "here"), without_times(tmp_path / "plain")
    assert here.keys() == plain.keys()
    for name in here:
        assert here[name] == plain[name], name


@pytest.fixture(scope="module")
def linked():
    if json.loads(run("--version", "--json").out)["libraries"]["musl"] is None:
        pytest.skip("built with the system's elementary functions (musl-dev was not installed)")


def sections(tmp_path):
    path = tmp_path / "sections.json"
    assert run("design", "highpass", "--family", "chebyshev1", "--order", 3, "--ripple-db", 1, "--corner-hz", 200, "-o", path).status == 0
    return path


def test_capacitors_of_a_board(linked, tmp_path):
    both_ways(tmp_path, "fpaa", sections(tmp_path), "--from-hz", 20, "--to-hz", 2000)


def test_parts_of_a_circuit(linked, tmp_path):
    both_ways(tmp_path, "spice", sections(tmp_path))


def test_names_of_what_is_missing(linked, tmp_path):
    folder = EXAMPLES / "course" / "case04"
    both_ways(tmp_path, "diagnose", folder / "model.toml", "--data", folder / "train.csv", "--holdout", folder / "holdout.csv")
