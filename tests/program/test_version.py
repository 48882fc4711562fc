"""--version, and what --version --json says of the build."""

import json

from conftest import ROOT, run


def test_one_line_and_its_facts():
    line = run("--version")
    assert line.status == 0 and line.out.count("\n") == 1
    facts = json.loads(run("--version", "--json").out)
    assert line.out == f"bodesmith {facts['version']}\n"
    assert facts["schema"] == "bodesmith.version/1"
    for key in ("compiler", "compiler_flags", "build_type", "system"):
        assert facts[key], key
    libraries = facts["libraries"]
    assert set(libraries) >= {"eigen", "sundials", "boost", "nlohmann_json", "tomlplusplus", "fmt", "openssl", "matio"}
    for name, version in libraries.items():
        assert name in ("mpi", "musl") and not version or version[0].isdigit(), (name, version)
    assert set(facts["options"].values()) <= {True, False} and "unity" in facts["options"]
    assert facts["commit"] is None or len(facts["commit"]) >= 7
    if not (ROOT / ".git").exists():
        assert facts["commit"] is None
    assert run("--version", "--jsn").status == 2
