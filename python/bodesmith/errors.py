"""What can go wrong, as exceptions. A numerical outcome (a limit not met, a search that stopped) is data, never one of these."""

from __future__ import annotations


class InputError(ValueError):
    """Something that was given is wrong: a value, a file, an option.

    `str(error)` is one line: what is wrong and what was expected, for files `FILE:LINE: …` in front.

    Attributes:
        file: path of the file to blame, as it was given; None when none is.
        line: its line, counted from 1; None when no single line is to blame.
    """

    def __init__(self, message: str, file: str | None = None, line: int | None = None) -> None:
        super().__init__(message)
        self.file = file
        self.line = line


class DesignError(InputError):
    """A design that cannot be made or does not fit (too many sections for the board, no legal clock). Says what would fit."""


class BodesmithWarning(UserWarning):
    """What a person should know of a result; also in the result's `warnings`."""
