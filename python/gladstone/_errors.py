"""Exceptions of gladstone."""

from __future__ import annotations

import re
from typing import NamedTuple


class GladstoneWarning(UserWarning):
    """Warning about a setup, a rendering, a measurement or a comparison."""


class Error(Exception):
    """Base class of the exceptions of gladstone."""


class Problem(NamedTuple):
    """One problem of a setup."""

    file: str | None
    """Name of the setup file; None: the value was given by `Setup.replace`."""
    line: int | None
    """Line in the file, from 1."""
    column: int | None
    """Column in the line, from 1."""
    key: str | None
    """Key path, such as "lens.f_number"."""
    text: str
    """What is wrong, and how to correct it."""
    code: str | None
    """Code of the problem; None: this kind of problem has no code yet."""

    def __str__(self) -> str:
        place = f"replace({self.key!r})" if self.file is None else self.file
        if self.line is not None:
            place += f":{self.line}:{self.column}"
        return f"{place}: {self.text}"


_PLACE = re.compile(r"(?P<file>.*?):(?P<line>\d+):(?P<column>\d+)\Z", re.DOTALL)
_UNKNOWN_KEY = re.compile(r'unknown (?:key|table) "(?P<key>[^"]+)"(?: in \[(?P<table>[^\]]+)\])?')
_UNKNOWN_TABLE = re.compile(r"unknown table \[(?P<key>[^\]]+)\]")
_KEY = re.compile(r"\[?(?P<key>[A-Za-z_][\w.\[\]-]*?)\]?(?: = .*?)?(?:: | )", re.DOTALL)


def _key_of(text: str) -> str | None:
    if match := _UNKNOWN_KEY.match(text):
        table = match["table"]
        return f"{table}.{match['key']}" if table else match["key"]
    if match := _UNKNOWN_TABLE.match(text):
        return match["key"]
    match = _KEY.match(text)
    return match["key"] if match and ("." in match["key"] or text.startswith("[")) else None


def _problem(where: str, text: str) -> Problem:
    if where.startswith("--set "):
        key = where.removeprefix("--set ").split("=", 1)[0].strip()
        return Problem(None, None, None, key, text, None)
    if match := _PLACE.match(where):
        return Problem(match["file"], int(match["line"]), int(match["column"]), _key_of(text), text, None)
    return Problem(where, None, None, _key_of(text), text, None)


class SetupError(Error, ValueError):
    """A setup with problems; `problems` lists all of them."""

    problems: tuple[Problem, ...]

    def __init__(self, problems=(), more: int = 0):
        self.problems = tuple(_problem(*one) if len(one) == 2 else Problem(*one) for one in problems)
        self.more = more
        text = "\n".join(str(problem) for problem in self.problems)
        super().__init__(f"{text}\nand {more} problems more" if more else text)

    def __reduce__(self):
        return type(self), ([tuple(problem) for problem in self.problems], self.more)


class _FileError(Error):
    file: str
    """File or input in which the problem is."""
    text: str
    """What is wrong, and how to correct it."""

    def __init__(self, file: str, text: str):
        self.file, self.text = file, text
        super().__init__(f"{file}: {text}")

    def __reduce__(self):
        return type(self), (self.file, self.text)


class DataError(_FileError, ValueError):
    """A file or an array that is missing, damaged or of unexpected content."""


class NoValidVector(DataError):
    """A displacement field without a single valid vector."""


class OutOfMemory(DataError, MemoryError):
    """A computation that needs more memory than is available."""


class OutputError(_FileError):
    """A file that cannot be written."""


class DeviceError(Error, RuntimeError):
    """An accelerator that is absent, out of memory or failing."""
