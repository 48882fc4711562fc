"""What all results have in common: the program's own files."""

from __future__ import annotations

import copy
import json
import os
from typing import Any, ClassVar, TypeVar

from ._call import Answer, call, plain

Self = TypeVar("Self", bound="Document")
PathLike = str | os.PathLike[str]


class Document:
    """A result in the form of its file (`bodesmith.NAME/1`), which the program reads and writes too.

    Attributes:
        warnings: what a person should know, one sentence each.
        files: texts that the program writes beside the main file, by name (netlists, build sheets, drawings).
    """

    _name: ClassVar[str] = ""
    _file: ClassVar[str] = ""
    """Name of the main file where there are several."""

    def __init__(self, data: dict[str, Any], *, files: dict[str, str] | None = None, warnings: list[str] | None = None) -> None:
        self._data = data
        self.files = dict(files or {})
        self.warnings = list(warnings or [])

    @classmethod
    def _of(cls: type[Self], data: dict[str, Any], files: dict[str, str] | None = None, warnings: list[str] | None = None) -> Self:
        out = cls.__new__(cls)
        Document.__init__(out, data, files=files, warnings=warnings)
        return out

    @classmethod
    def _from(cls: type[Self], answer: Answer) -> Self:
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
        with open(path, encoding="utf-8-sig") as file:
            return cls._of(json.load(file))

    def save(self, path: PathLike) -> None:
        """Writes the main file, whole or not at all."""
        call("write_document", {"path": os.fspath(path), "text": json.dumps(self._data)})

    def write(self, folder: PathLike) -> None:
        """Writes the main file and all of `files` into a folder, which is made; all of them or none."""
        name = self._file or f"{self._name}.json"
        call("write_files", {"folder": os.fspath(folder), "files": {**self.files, name: self._text()}})

    def _text(self) -> str:
        return json.dumps(self._data, indent=2, ensure_ascii=False) + "\n"

    @property
    def compute_s(self) -> float | None:
        """Wall seconds of the work itself; None where it was read from a file without them."""
        return self._data.get("timing_s", {}).get("compute")

    def __repr__(self) -> str:
        return f"<bodesmith.{type(self).__name__} {self._summary()}>"

    def _summary(self) -> str:
        return self._data.get("schema", "")
