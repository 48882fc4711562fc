"""How pip builds the package (PEP 517): CMake makes the extension, the rest is a zip file. Standard library only.

The extension is built in build/, as ./run and ./test build the program, so what they compiled is not compiled again;
`pip install . --config-settings build-dir=DIR` builds elsewhere.
"""

from __future__ import annotations

import base64
import hashlib
import os
import pathlib
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def _project() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def _stem() -> str:
    project = _project()
    return f"{project['name']}-{project['version']}"


def _tag() -> str:
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


def _metadata() -> dict[str, str]:
    project = _project()
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {project['version']}"]
    lines += [f"Summary: {project['description']}", f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {one}" for one in project["dependencies"]]
    for extra, needs in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f'Requires-Dist: {one}; extra == "{extra}"' for one in needs)]
    lines += ["Description-Content-Type: text/markdown", "", (ROOT / project["readme"]).read_text(encoding="utf-8")]
    wheel = ["Wheel-Version: 1.0", "Generator: bodesmith_build", "Root-Is-Purelib: false", f"Tag: {_tag()}", ""]
    return {"METADATA": "\n".join(lines), "WHEEL": "\n".join(wheel)}


def _build(settings: dict | None) -> pathlib.Path:
    """Builds the extension; the folder in which the package stands."""
    folder = ROOT / (settings or {}).get("build-dir", "build")
    cache = folder / "CMakeCache.txt"
    configure = ["cmake", "--preset", "release", "-S", str(ROOT), "-B", str(folder), "-DBODESMITH_BUILD_PYTHON=ON"]
    configure.append(f"-DPython_EXECUTABLE={sys.executable}")
    if not cache.exists():
        configure += ["-DBODESMITH_BUILD_TESTS=OFF", "-DBODESMITH_BUILD_EXAMPLES=OFF"]
    # What an earlier build found belongs to its own Python.
    configure += ["-UPython_INCLUDE_DIR", "-UPython_LIBRARY*", "-U_Python_*", "-UPYTHON_*"]
    for command in (configure, ["cmake", "--build", str(folder), "--target", "bodesmith_python"]):
        subprocess.run(command, check=True, cwd=ROOT)
    return folder / "python"


def _write_wheel(path: pathlib.Path, content: dict[str, bytes]) -> None:
    record = f"{_stem()}.dist-info/RECORD"
    rows = []
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, data in content.items():
            info = zipfile.ZipInfo(name)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            wheel.writestr(info, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            rows.append(f"{name},sha256={digest},{len(data)}")
        wheel.writestr(record, "\n".join([*rows, f"{record},,", ""]))


def build_wheel(wheel_directory: str, config_settings: dict | None = None, metadata_directory: str | None = None) -> str:
    folder = _build(config_settings)
    extension = f"_core{sysconfig.get_config_var('EXT_SUFFIX')}"
    content: dict[str, bytes] = {}
    for source in sorted((ROOT / "python/bodesmith").iterdir()):
        if source.suffix in (".py", ".pyi") or source.name == "py.typed":
            content[f"bodesmith/{source.name}"] = source.read_bytes()
    content[f"bodesmith/{extension}"] = (folder / "bodesmith" / extension).read_bytes()
    content[f"{_stem()}.dist-info/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    for name, text in _metadata().items():
        content[f"{_stem()}.dist-info/{name}"] = text.encode()
    name = f"{_stem()}-{_tag()}.whl"
    _write_wheel(pathlib.Path(wheel_directory) / name, content)
    return name


def prepare_metadata_for_build_wheel(metadata_directory: str, config_settings: dict | None = None) -> str:
    folder = pathlib.Path(metadata_directory) / f"{_stem()}.dist-info"
    folder.mkdir()
    for name, text in _metadata().items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder.name


def build_sdist(sdist_directory: str, config_settings: dict | None = None) -> str:
    """What git knows, as it stands in the work tree."""
    listed = subprocess.run(["git", "ls-files", "-z"], check=True, cwd=ROOT, capture_output=True).stdout.decode()
    name = f"{_stem()}.tar.gz"
    with tarfile.open(os.path.join(sdist_directory, name), "w:gz") as archive:
        for path in filter(None, listed.split("\0")):
            if (ROOT / path).is_file():
                archive.add(ROOT / path, f"{_stem()}/{path}")
        (pathlib.Path(sdist_directory) / "PKG-INFO").write_text(_metadata()["METADATA"], encoding="utf-8")
        archive.add(os.path.join(sdist_directory, "PKG-INFO"), f"{_stem()}/PKG-INFO")
    os.remove(os.path.join(sdist_directory, "PKG-INFO"))
    return name


def get_requires_for_build_wheel(config_settings: dict | None = None) -> list[str]:
    return []


def get_requires_for_build_sdist(config_settings: dict | None = None) -> list[str]:
    return []
