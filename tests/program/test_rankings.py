"""What a step of `diagnose` says of its own name is of the set that stands, and no rival that it was held against is of greater evidence."""

import json
import sys

from conftest import ROOT, run

sys.path.insert(0, str(ROOT / "bench"))
import calibration  # noqa: E402


def test_a_name_that_stands_has_the_evidence_of_what_stands(tmp_path):
    """Drag beside a mode, drawn: the fit of drag's own name in its place, tried again beside the mode, stops short of the one that
    stands; the step was told with its evidence, as 8e-10."""
    drawn = calibration.make(404, str(tmp_path))
    assert drawn["kinds"] == ["drag"]
    done = run("diagnose", "model.toml", "--data", "a.csv", "b.csv", "--holdout", "h.csv", "-o", "out", "--quiet", cwd=tmp_path)
    assert done.status == 0, done.err
    told = json.loads((tmp_path / "out/diagnosis.json").read_text())
    assert "drag" in [step["effect"] for step in told["steps"]]
    for step in told["steps"]:
        named = [c for c in step["candidates"] if c["effect"] == step["effect"] and c["outcome"] == "named"]
        fitted = [c["log_evidence"] for c in step["candidates"] if c["log_evidence"] is not None]
        assert len(named) == 1 and named[0]["log_evidence"] == max(fitted)
        if step["effect"] == "drag":
            assert step["probability"] > 0.9
