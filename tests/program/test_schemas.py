"""The schemas hold: every file the program writes and every example validates, and what readers refuse, they refuse."""

import copy
import json
import re
import tomllib

import pytest
from conftest import ROOT, run

jsonschema = pytest.importorskip("jsonschema", reason="python3-jsonschema is not installed")

FOLDER = ROOT / "schemas"
SCHEMAS = {file.name.split(".")[0]: json.loads(file.read_text()) for file in sorted(FOLDER.glob("*.schema.json"))}


def name_of(document):
    return re.fullmatch(r"bodesmith\.([a-z_]+)/1", document["schema"])[1]


def check(document, where):
    validator = jsonschema.Draft202012Validator(SCHEMAS[name_of(document)])
    error = jsonschema.exceptions.best_match(validator.iter_errors(document))
    assert error is None, f"{where}: {'/'.join(map(str, error.absolute_path))}: {error.message}"


def load(file):
    return tomllib.loads(file.read_text()) if file.suffix == ".toml" else json.loads(file.read_text())


def test_they_are_schemas_of_draft_2020_12():
    assert len(SCHEMAS) > 30
    for name, schema in SCHEMAS.items():
        jsonschema.Draft202012Validator.check_schema(schema)
        assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
        assert schema["$id"] == name + ".schema.json"
        assert schema["properties"]["schema"] == {"const": f"bodesmith.{name}/1"}
        assert "schema" in schema["required"]


def test_the_registries_have_nothing_else(tmp_path):
    # Block types, effects, CAMs and methods stand in the schemas as the registries have them.
    assert run("schema", "-o", tmp_path).status == 0
    for file in FOLDER.glob("*.schema.json"):
        assert (tmp_path / file.name).read_text() == file.read_text(), f"{file.name}: bodesmith schema -o schemas writes it anew"


def test_every_schema_the_sources_name_is_there():
    text = "\n".join(file.read_text() for file in (ROOT / "src").rglob("*.cpp"))
    named = set(re.findall(r"(?:json_header|timed_document|artefact_json|json_file|document|expect_schema)\(\s*\"([a-z_]+)\"", text))
    assert len(named) > 25
    commands_only = {"version", "completion_summary", "manual_summary", "schema_summary", "new_summary"}
    assert named - commands_only <= set(SCHEMAS), named - commands_only - set(SCHEMAS)


@pytest.mark.parametrize("file", sorted(FOLDER.parent.glob("examples/*/*.toml")) + sorted(FOLDER.parent.glob("examples/*/*.json")), ids=lambda f: f"{f.parent.name}/{f.name}")
def test_examples_validate(file):
    check(load(file), file)


def test_the_library_of_op_amps_validates():
    check(load(ROOT / "templates/spice/opamps.toml"), "opamps.toml")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Files of most subcommands, each from a quick run, and their --json summaries."""
    folder = tmp_path_factory.mktemp("written")
    gains = ROOT / "examples/nanopositioner/gains.csv"
    disturbance = ROOT / "examples/nanopositioner/disturbance.json"
    stage = ROOT / "examples/piezo_loop/stage.toml"
    summaries = []

    def do(*arguments, statuses=(0,)):
        result = run(*arguments, "--json", cwd=folder)
        assert result.status in statuses, f"{arguments}: {result.err}"
        summaries.append(json.loads(result.out))

    do("fit", gains, "-o", "cascade.json")
    do("fit", ROOT / "examples/riaa/points.csv", "--direct", "--order", "3", "-o", "direct.json")
    do("approximate", "cascade.json", "-o", "sections.json", "--order", "2")
    do("approximate", ROOT / "examples/fractional_pid/pid.toml", "--from-hz", "1", "--to-hz", "100", "--order", "5", "-o", "pid.json")
    do("design", "lowpass", "--order", "3", "--corner-hz", "1k", "-o", "lowpass.json")
    do("fpaa", "lowpass.json", "-o", "fpaa", "--topology", "chain", "--stream")
    do("fpaa", "verify", "fpaa/plan.json", "fpaa/stream/packets.bin", statuses=(0, 1))
    do("fpaa", "disassemble", "fpaa/stream/chip1.ahf", "-o", "netlist.json")
    do("spice", "lowpass.json", "-o", "spice", statuses=(0, 1))
    do("layout", disturbance, "-o", "layout")
    do("bode", "sections.json", "-o", "bode.csv")
    do("tune", "lowpass.json", "--bandwidth-hz", "100", "-o", "controller.json")
    do("export", "lowpass.json", "-o", "lowpass.m")
    do("design", "lowpass", "--order", "1", "--corner-hz", "1k", "-o", "pole.json")
    do("yield", "pole.json", "-o", "yield.json", "--samples", "64", "--limit-db", "1")
    do("compensate", stage, "--reference", "triangle", "--frequency-hz", "10", "--inverse", "inverse.toml", "-o", "drive.csv")
    do("simulate", stage, "--input", "drive.csv", "-o", "y.csv")
    do("identify", "y.csv", "--model", "polynomial_hysteresis", "-o", "model.toml")
    # Full strokes: a training turn and a held-out one.
    times = [i / 200 for i in range(801)]
    for hz, bend in (("1", -0.3), ("2", -0.36)):
        rows = []
        for t in times:
            x = 1 - abs((t % 1.0) * 2 - 1)
            rows.append(f"{t / float(hz)},{x},{x + (bend if t % 1.0 < 0.5 else 0.2) * x * (1 - x)}")
        (folder / f"f{hz}.csv").write_text("\n".join(["time_s,u,y", *rows]) + "\n")
    do("identify", "f1.csv", "f2.csv", "--disturbance", "stage.json", "--gains", "stage_gains.csv", "--max-error-percent", "5")
    do("model", "stage.json", "-o", "stage.toml")
    do("model", "sections.json", "lowpass.json", "-o", "chain.toml")
    do("new", "diagnosis", "--kind", "diagnosis")
    do("diagnose", "diagnosis/model.toml", "--data", "diagnosis/train.csv", "--holdout", "diagnosis/test.csv", "--max-terms", "1", "-o", "gap")
    return folder, summaries


def test_everything_written_validates(written):
    folder, summaries = written
    files = [file for file in folder.rglob("*") if file.suffix in (".json", ".toml") and not file.name.endswith(".schema.json")]
    seen = set()
    for file in files:
        document = load(file)
        check(document, file)
        seen.add(name_of(document))
    for summary in summaries:
        if name_of(summary) not in ("new_summary",):
            check(summary, "summary")
            seen.add(name_of(summary))
    assert seen >= {"cascade", "sections", "fpaa_plan", "fpaa_netlist", "circuit", "layout", "yield", "model", "inverse", "diagnosis", "disturbance_identification", "model_summary"}


def broken(document, name):
    """Copies of a document with one thing wrong each, as a slip would make it."""
    for key in SCHEMAS[name]["required"]:
        out = copy.deepcopy(document)
        del out[key]
        yield f"without {key}", out
    if SCHEMAS[name].get("additionalProperties") is False:
        yield "with a key that is not known", {**document, "colour": 1}


@pytest.mark.parametrize("kind", ["filter", "fractional-pid", "nanopositioner", "diagnosis"])
def test_readers_and_schemas_refuse_the_same(kind, tmp_path):
    made = run("new", tmp_path / "p", "--kind", kind)
    assert made.status == 0, made.err
    files = [file for file in (tmp_path / "p").iterdir() if file.suffix in (".toml", ".json")]
    assert files
    for file in files:
        document = load(file)
        check(document, file)
        for what, wrong in broken(document, name_of(document)):
            schema = SCHEMAS[name_of(document)]
            assert not jsonschema.Draft202012Validator(schema).is_valid(wrong), (file, what)
            as_json = tmp_path / "p" / (file.stem + "_wrong.json")
            as_json.write_text(json.dumps(wrong))
            command = {"project": ["run", as_json], "model": ["simulate", as_json, "--reference", "sine", "--frequency-hz", "10"],
                       "fractional": ["approximate", as_json, "--from-hz", "1", "--to-hz", "10", "--order", "3"],
                       "disturbance": ["layout", as_json]}[name_of(document)]
            said = run(*command, "-o", tmp_path / "out")
            assert said.status == 2, (file, what, said.out)


def test_readers_pass_over_the_key_for_editors(tmp_path):
    stage = load(ROOT / "examples/piezo_loop/stage.toml")
    (tmp_path / "model.json").write_text(json.dumps({"$schema": "x.json", **stage}))
    said = run("simulate", tmp_path / "model.json", "--reference", "sine", "--frequency-hz", "10", "-o", tmp_path / "y.csv")
    assert said.status == 0, said.err
