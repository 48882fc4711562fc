"""Every option of every subcommand completes in bash, and zsh and fish know the same ones."""

import shutil
import subprocess

import pytest
from conftest import options_in, run


def complete(script, *words):
    """What bash offers behind these words, the last one not yet finished."""
    quoted = " ".join("'" + word + "'" for word in words)
    code = f"""
source {script}
COMP_WORDS=({quoted}); COMP_CWORD=$(( ${{#COMP_WORDS[@]}} - 1 ))
_bodesmith 2>/dev/null
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
    done = subprocess.run(["bash", "--norc", "-c", code], capture_output=True, text=True, timeout=30)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.split())


@pytest.fixture(scope="module")
def bash(tmp_path_factory):
    script = tmp_path_factory.mktemp("completion") / "bodesmith"
    result = run("completion", "bash", "-o", script)
    assert result.status == 0, result.err
    return script


def test_every_option_completes_in_bash(bash, help_texts):
    assert len(help_texts) > 20
    for name, text in help_texts.items():
        wanted = {"--" + option for option in options_in(text)}
        assert {"--help", "--json", "--quiet"} <= wanted, name
        assert wanted == complete(bash, "bodesmith", *name.split(), "--"), name


def test_subcommands_verbs_and_words_complete_in_bash(bash, tmp_path, monkeypatch):
    assert complete(bash, "bodesmith", "co") == {"controller", "compensate", "completion"}
    assert complete(bash, "bodesmith", "fpaa", "st") >= {"streams"}
    assert complete(bash, "bodesmith", "approximate", "--method", "ou") == {"oustaloup"}
    assert complete(bash, "bodesmith", "design", "low") == {"lowpass", "low-shelf"}
    # --name=value, which bash hands on as three words
    assert complete(bash, "bodesmith", "simulate", "--engine", "=", "cv") == {"cvode"}
    monkeypatch.chdir(tmp_path)
    for file in ("model.toml", "record.csv", "plan.json"):
        (tmp_path / file).touch()
    assert complete(bash, "bodesmith", "simulate", "") == {"model.toml", "plan.json"}
    assert complete(bash, "bodesmith", "compensate", "") == {"model.toml"}
    assert complete(bash, "bodesmith", "spice", "p") == {"plan.json"}
    assert complete(bash, "bodesmith", "simulate", "model.toml", "--input", "r") == {"record.csv"}


def test_the_other_shells_know_the_same_options(help_texts):
    zsh = run("completion", "zsh").out
    fish = run("completion", "fish").out
    for name, text in help_texts.items():
        function = zsh.split("_bodesmith_" + name.replace(" ", "_") + "() {")[1].split("\n}")[0]
        lines = [line for line in fish.splitlines() if f"'__bodesmith_at {name}'" in line]
        for option in options_in(text):
            assert f"--{option}[" in function or f"--{option}}}'[" in function, (name, option)
            assert any(f" -l {option} " in line for line in lines), (name, option)


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_the_scripts_parse(shell, tmp_path):
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    script = tmp_path / "script"
    script.write_text(run("completion", shell).out)
    done = subprocess.run([shell, "-n", str(script)], capture_output=True, text=True, timeout=30)
    assert done.returncode == 0 and done.stderr == "", done.stderr


def test_fish_completes(tmp_path):
    if shutil.which("fish") is None:
        pytest.skip("fish is not installed")
    script = tmp_path / "bodesmith.fish"
    script.write_text(run("completion", "fish").out)
    code = f"source {script}; complete -C 'bodesmith fpaa str'; complete -C 'bodesmith approximate --method ou'"
    done = subprocess.run(["fish", "--no-config", "-c", code], capture_output=True, text=True, timeout=30)
    assert "streams" in done.stdout and "oustaloup" in done.stdout, done.stdout + done.stderr
