"""The manual pages hold what --help shows, and are good roff."""

import re
import shutil
import subprocess

import pytest
from conftest import options_in, run


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("man")
    assert run("manual", "-o", folder).status == 0
    return folder


def page_of(folder, name):
    return folder / ("bodesmith-" + name.replace(" ", "-") + ".1")


def test_a_page_for_every_subcommand_with_every_option(pages, help_texts):
    for name, text in help_texts.items():
        page = page_of(pages, name).read_text().replace("\\-", "-")
        shown = set(re.findall(r"^\.(?:B|BI|BR) (?:-\w \", )?--([a-z0-9-]+)", page, re.M))
        assert options_in(text) == shown, name
        example = text.splitlines()[1].strip()
        assert example in page, name
    overview = (pages / "bodesmith.1").read_text()
    for name in help_texts:
        assert "bodesmith\\-" + name.replace(" ", "\\-") in overview
    assert len(list(pages.iterdir())) == len(help_texts) + 1


def test_mandoc_has_nothing_to_say(pages):
    if shutil.which("mandoc") is None:
        pytest.skip("mandoc is not installed")
    done = subprocess.run(["mandoc", "-Tlint", "-W", "warning", *map(str, sorted(pages.iterdir()))], capture_output=True, text=True, timeout=60)
    assert done.stdout == "" and done.returncode == 0, done.stdout[:2000]


def test_man_shows_a_page_without_warnings(pages):
    if shutil.which("man") is None:
        pytest.skip("man is not installed")
    done = subprocess.run(
        ["man", "--warnings", "-l", str(page_of(pages, "fit"))],
        capture_output=True,
        text=True,
        timeout=60,
        env={"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "MANPAGER": "cat", "MANWIDTH": "100"},
    )
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert "--max-error-db value" in re.sub(r".\x08", "", done.stdout)
