"""The package itself: types, version, the example."""

from __future__ import annotations

import ast
import importlib.util
import inspect
import pathlib
import tomllib

import bodesmith as bs
from conftest import ROOT


def test_version_is_the_programs():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert bs.__version__ == project["version"]
    assert f"project(bodesmith VERSION {project['version']} " in (ROOT / "CMakeLists.txt").read_text()


def test_everything_public_is_typed_and_explained():
    assert (pathlib.Path(bs.__file__).parent / "py.typed").exists()
    for name in bs.__all__:
        thing = getattr(bs, name)
        if not (inspect.isfunction(thing) or inspect.isclass(thing)):
            continue
        assert inspect.getdoc(thing), name
        if inspect.isfunction(thing):
            hints = inspect.signature(thing)
            assert hints.return_annotation is not inspect.Signature.empty, name
            for parameter in hints.parameters.values():
                assert parameter.annotation is not inspect.Parameter.empty, f"{name}({parameter.name})"


def test_the_example_runs_from_points_to_hardware(tmp_path):
    path = ROOT / "examples/python/nanopositioner.py"
    spec = importlib.util.spec_from_file_location("nanopositioner", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    figures = module.main(tmp_path)
    assert figures["fit_max_db"] < 1e-12
    assert figures["approximation_db"] < 0.05
    assert figures["fpaa_percent"] < 1.0
    assert figures["circuit_db"] < 0.05
    assert figures["tracking_percent"] < 0.2 * figures["uncompensated_percent"]
    for name in ("cascade.json", "sections.json", "fpaa/plan.json", "spice/compensator.sub", "layout/disturbance.sub", "bode.svg"):
        assert (tmp_path / name).stat().st_size > 0, name


def test_modules_import_one_another_in_one_direction() -> None:
    """Plots know results, results not plots: no module reaches itself, by imports inside functions either."""
    modules = {path.stem: path for path in pathlib.Path(bs.__file__).parent.glob("*.py")}
    known = {}
    for name, path in modules.items():
        nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        known[name] = {n.module for n in nodes if isinstance(n, ast.ImportFrom) and n.level == 1 and n.module in modules}
    for name in modules:
        reached: set[str] = set()
        step = known[name]
        while step - reached:
            reached |= step
            step = set().union(*(known[other] for other in reached))
        assert name not in reached
