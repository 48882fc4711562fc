"""What all results have in common: the program's own files."""

from __future__ import annotations

import copy
import hashlib
import json
import os
from typing import Any, ClassVar, TypeVar

from . import _core
from ._call import Answer, call, plain

Self = TypeVar("Self", bound="Document")
PathLike = str | os.PathLike[str]


def origin_of(path: PathLike, content: bytes) -> dict[str, str]:
    return {"path": os.fspath(path), "sha256": hashlib.sha256(content).hexdigest()}


def origins(*things: Any) -> list[dict[str, str]]:
    """Path and SHA-256 of every file that these came from, each once."""
    out: list[dict[str, str]] = []
    for thing in things:
        out += [one for one in getattr(thing, "origins", []) if one not in out]
    return out


class Document:
    """A result in the form of its file (`bodesmith.NAME/1`), which the program reads and writes too.

    Attributes:
        warnings: what a person should know, one sentence each.
        files: texts that the program writes alongside the main file, by name (netlists, build sheets, drawings).
        origins: path and SHA-256 of the files that it came from; `inputs` of what is computed from it.
    """

    _name: ClassVar[str] = ""
    _file: ClassVar[str] = ""
    """Name of the main file where there are several."""

    def __init__(self, data: dict[str, Any], *, files: dict[str, str] | None = None, warnings: list[str] | None = None) -> None:
        self._data = data
        self.origins: list[dict[str, str]] = data.get("inputs", [])
        self.files = dict(files or {})
        self.warnings = list(warnings or [])

    @classmethod
    def _of(cls: type[Self], data: dict[str, Any], files: dict[str, str] | None = None, warnings: list[str] | None = None) -> Self:
        out = cls.__new__(cls)
        Document.__init__(out, data, files=files, warnings=warnings)
        return out

    @classmethod
    def _from(cls: type[Self], answer: Answer, *things: Any) -> Self:
        if "inputs" in answer.result:
            answer.result["inputs"] = origins(*things)
        return cls._of(answer.result, answer.files, answer.warnings)

    def to_dict(self) -> dict[str, Any]:
        """The file's content; a copy."""
        return copy.deepcopy(self._data)

    @classmethod
    def from_dict(cls: type[Self], data: dict[str, Any]) -> Self:
        """From a file's content. Raises InputError that names the place when it is not one."""
        data = plain(data, "")
        data.setdefault("schema", f"bodesmith.{cls._name}/1")
        call("check_document", {"schema": cls._name, "document": data})
        return cls._of(data)

    @classmethod
    def load(cls: type[Self], path: PathLike) -> Self:
        """Reads a file of this kind. Raises InputError with `.file` and `.line`."""
        call("read_document", {"schema": cls._name, "path": os.fspath(path)})
        with open(path, "rb") as file:
            content = file.read()
        out = cls._of(json.loads(content))
        out.origins = [origin_of(path, content)]
        return out

    def save(self, path: PathLike) -> None:
        """Writes the main file, whole or not at all."""
        call("write_document", {"path": os.fspath(path), "text": json.dumps(self._whole())})

    def write(self, folder: PathLike) -> None:
        """Writes the main file and all of `files` into a folder, which is made; all of them or none."""
        name = self._file or f"{self._name}.json"
        call("write_files", {"folder": os.fspath(folder), "files": {**self.files, name: self._text()}})

    def _text(self) -> str:
        return json.dumps(self._whole(), indent=2, ensure_ascii=False) + "\n"

    def _whole(self) -> dict[str, Any]:
        """With the header that every file of the program has."""
        header = {"schema": f"bodesmith.{self._name}/1", "program": f"bodesmith {_core.version}", "inputs": []}
        return {**header, **self._data}

    @property
    def compute_s(self) -> float | None:
        """Wall seconds of the work itself; None where it was read from a file without them."""
        return self._data.get("timing_s", {}).get("compute")

    def __repr__(self) -> str:
        return f"<bodesmith.{type(self).__name__} {self._summary()}>"

    def _summary(self) -> str:
        return self._data.get("schema", "")
