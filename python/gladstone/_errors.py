"""Exceptions of gladstone."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from numbers import Integral
from typing import NamedTuple

from ._arguments import CalledFunction


def check_choice(name: str, given: str, choices: Sequence[str]) -> None:
    """Raises ValueError if an argument is not one of its choices."""
    if given not in choices:
        listed = ", ".join(f'"{one}"' for one in choices[:-1]) + f' or "{choices[-1]}"'
        raise ValueError(f"{name} must be {listed}, got {given!r}")


def check_whole(name: str, given: int, least: int, most: int) -> None:
    """Raises ValueError if an argument is not a whole number from `least` to `most`."""
    if not isinstance(given, Integral) or not least <= given <= most:
        raise ValueError(f"{name} must be a whole number from {least} to {most}, got {given!r}")


class WarningText(str):
    """Warning of a result, "place: text", with its parts as attributes."""

    code: str
    """Kind of the warning, such as "low_accuracy"; docs/reference/errors.md lists all."""
    place: str
    """File, "file:line", key path of the setup or argument that it is about; may be empty."""
    text: str
    """Description, with the remedy."""

    def __new__(cls, code: str, place: str, text: str):
        self = super().__new__(cls, f"{place}: {text}" if place else text)
        self.code, self.place, self.text = code, place, text
        return self

    def __getnewargs__(self):
        return self.code, self.place, self.text


class GladstoneWarning(UserWarning):
    """Warning about a setup, a rendering, a measurement or a comparison, with `code`, `place` and `text` as attributes;
    see `WarningText`."""

    def __init__(self, warning: WarningText):
        super().__init__(warning)
        self.code, self.place, self.text = warning.code, warning.place, warning.text


class Error(Exception):
    """Base class of the exceptions of gladstone."""

    code: str = "internal"
    """Kind of the error, as `gladstone --json` reports it (docs/reference/errors.md)."""


class Problem(NamedTuple):
    """One problem of a setup."""

    file: str | None
    """Name of the setup file; None if the value was given to a function, such as `Setup.replace`."""
    line: int | None
    """Line in the file, from 1."""
    column: int | None
    """Column in the line, from 1."""
    key: str | None
    """Key path, such as "lens.f_number", or name of an argument, such as "window"."""
    text: str
    """Description of the problem, with its remedy."""
    code: str
    """Kind of the problem, such as "unknown_key"; docs/reference/errors.md lists all."""

    @property
    def place(self) -> str:
        """Location "file:line:column", or the key or argument; may be empty."""
        if self.file is None:
            return self.key or ""
        line = "" if self.line is None else f":{self.line}" + (f":{self.column}" if self.column else "")
        return self.file + line

    def __str__(self) -> str:
        if self.file is None and self.key and self.key in self.text:  # no need to name it twice
            return self.text
        return f"{self.place}: {self.text}" if self.place else self.text


_PLACE = re.compile(r"(?P<file>.*?)(?::(?P<line>\d+)(?::(?P<column>\d+))?)?\Z", re.DOTALL)


def _problem(where: str, text: str, key: str, code: str) -> Problem:
    """Makes a problem; `where` is its location, "file:line:column", "--set key=value" or another option."""
    if where.startswith("--"):
        called = CalledFunction()
        name = called.setting(key) if where.startswith("--set ") else called.option(where) or where
        unknown = code == "unknown_key" and name != key and "." not in name
        text = called.unknown_setting(name) if unknown else called.message(text)
        return Problem(None, None, None, name or None, text, code)
    match = _PLACE.match(where)
    line, column = (int(match[name]) if match[name] else None for name in ("line", "column"))
    return Problem(match["file"], line, column, key or None, text, code)


class SetupError(Error, ValueError):
    """A setup with problems; `problems` lists them, `more` is the number of further ones. `file`, `line`, `column`, `key`,
    `place`, `text` and `code` are those of the first problem."""

    code = "invalid_value"
    place: str = ""
    file: str | None = None
    line: int | None = None
    column: int | None = None
    key: str | None = None
    text: str = ""
    problems: tuple[Problem, ...]
    """Problems of the setup, each with file, line, column, key, text and code."""
    more: int
    """Number of further problems, which are not listed."""

    def __init__(self, problems: Iterable[Problem | tuple[str, str, str, str]] = (), more: int = 0):
        self.problems = tuple(one if isinstance(one, Problem) else _problem(*one) for one in problems)
        self.more = more
        if self.problems:
            self.file, self.line, self.column, self.key, self.text, self.code = self.problems[0]
            self.place = self.problems[0].place
        text = "\n".join(str(problem) for problem in self.problems)
        super().__init__(f"{text}\nand {more} problems more" if more else text)

    def __reduce__(self):
        return type(self), (self.problems, self.more)


class _PlacedError(Error):
    place: str
    """File with line and column, name of the input, key path of the setup, or name of the argument."""
    file: str | None
    """File or name of the input with the problem; None if a key of the setup or an argument is wrong."""
    line: int | None
    """Line in the file, from 1."""
    column: int | None
    """Column in the line, from 1."""
    key: str | None
    """Key path of the setup, such as "lens.f_number", or name of an argument, such as "spacing_mm"."""
    text: str
    """Description of the problem, with its remedy."""

    def __init__(self, place: str, text: str, code: str | None = None, key: str = ""):
        called = CalledFunction()
        if place.startswith("--"):
            place = key = called.option(place) or place
        self.place, self.text = place, called.message(text)
        self.code = code or type(self).code
        self.key = key or None
        match = _PLACE.match(place)
        self.file = None if key else match["file"]
        self.line = int(match["line"]) if match["line"] else None
        self.column = int(match["column"]) if match["column"] else None
        super().__init__(f"{place}: {self.text}")

    def __reduce__(self):
        return type(self), (self.place, self.text, self.code, self.key or "")


class DataError(_PlacedError, ValueError):
    """Error for a file or an array that is missing, damaged or of unexpected content."""

    code = "invalid_value"


class NoValidVector(DataError):
    """Error for a displacement field without a single valid vector."""

    code = "no_valid_vector"


class OutOfMemory(DataError, MemoryError):
    """Error for a computation that requires more memory than is available."""

    code = "memory"


class OutputError(_PlacedError):
    """Error for a file that cannot be written."""

    code = "output"


class DeviceError(Error, RuntimeError):
    """Error for a GPU that is absent, out of memory or failing."""

    code = "device"
    file = line = column = key = None
    place = ""

    def __init__(self, text: str):
        self.text = CalledFunction().message(text)
        super().__init__(self.text)


@contextmanager
def hidden_folder(folder: str) -> Iterator[None]:
    """Context manager that removes the name of a temporary folder from exceptions. For a setup in this folder, which
    the user gave as an object, file, line and column are removed as well."""

    def inside(file: str | None) -> bool:
        return file is not None and file.startswith(folder + os.sep)

    def without_folder(text: str) -> str:
        return text.replace(folder + os.sep, "")

    def shown(problem: Problem) -> Problem:
        where = {"file": None, "line": None, "column": None} if inside(problem.file) else {}
        return problem._replace(text=without_folder(problem.text), **where)

    try:
        yield
    except SetupError as error:
        if not any(inside(problem.file) for problem in error.problems):
            raise
        raise SetupError(map(shown, error.problems), error.more) from None
    except (DataError, OutputError) as error:
        if not inside(error.file):
            raise
        raise type(error)(without_folder(error.place), without_folder(error.text), error.code) from None
