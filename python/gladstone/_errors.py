"""Exceptions of gladstone."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple


def check_choice(name: str, given: str, choices: Sequence[str]) -> None:
    """Raises ValueError if an argument is not one of its choices."""
    if given not in choices:
        listed = ", ".join(f'"{one}"' for one in choices[:-1]) + f' or "{choices[-1]}"'
        raise ValueError(f"{name} must be {listed}, got {given!r}")


class GladstoneWarning(UserWarning):
    """Warning about a setup, a rendering, a measurement or a comparison."""


class Error(Exception):
    """Base class of the exceptions of gladstone."""

    code: str = "data"
    """Kind of the error, as `gladstone --json` reports it; each problem of a `SetupError` has its own."""


class Problem(NamedTuple):
    """One problem of a setup."""

    file: str | None
    """Name of the setup file; None if the value was given by `Setup.replace`."""
    line: int | None
    """Line in the file, from 1."""
    column: int | None
    """Column in the line, from 1."""
    key: str | None
    """Key path, such as "lens.f_number"."""
    text: str
    """Description of the problem, with its remedy."""
    code: str
    """Kind of the problem: "invalid_value", "unknown_key", "missing_key", "wrong_type", "out_of_range",
    "unknown_choice", "syntax", "unreadable_file" or "memory"."""

    def __str__(self) -> str:
        place = f"replace({self.key!r})" if self.file is None else self.file
        if self.line is not None:
            place += f":{self.line}:{self.column}"
        return f"{place}: {self.text}"


_PLACE = re.compile(r"(?P<file>.*?):(?P<line>\d+):(?P<column>\d+)\Z", re.DOTALL)


def _problem(where: str, text: str, key: str, code: str) -> Problem:
    """Makes a problem; `where` is its location, "file:line:column" or "--set key=value"."""
    if where.startswith("--set "):
        return Problem(None, None, None, key or None, text, code)
    if match := _PLACE.match(where):
        return Problem(match["file"], int(match["line"]), int(match["column"]), key or None, text, code)
    return Problem(where, None, None, key or None, text, code)


class SetupError(Error, ValueError):
    """A setup with problems; `problems` lists them, `more` is the number of further ones."""

    code = "setup"
    problems: tuple[Problem, ...]
    """Problems of the setup, each with file, line, column, key, text and code."""
    more: int
    """Number of further problems, which are not listed."""

    def __init__(self, problems: Iterable[Problem | tuple[str, str, str, str]] = (), more: int = 0):
        self.problems = tuple(one if isinstance(one, Problem) else _problem(*one) for one in problems)
        self.more = more
        text = "\n".join(str(problem) for problem in self.problems)
        super().__init__(f"{text}\nand {more} problems more" if more else text)

    def __reduce__(self):
        return type(self), (self.problems, self.more)


class _FileError(Error):
    file: str
    """File or input in which the problem is."""
    text: str
    """Description of the problem, with its remedy."""

    def __init__(self, file: str, text: str):
        self.file, self.text = file, text
        super().__init__(f"{file}: {text}")

    def __reduce__(self):
        return type(self), (self.file, self.text)


class DataError(_FileError, ValueError):
    """A file or an array that is missing, damaged or of unexpected content."""


class NoValidVector(DataError):
    """A displacement field without a single valid vector."""

    code = "no_valid_vector"


class OutOfMemory(DataError, MemoryError):
    """A computation that needs more memory than is available."""

    code = "memory"


class OutputError(_FileError):
    """A file that cannot be written."""

    code = "output"


class DeviceError(Error, RuntimeError):
    """An accelerator that is absent, out of memory or failing."""

    code = "device"
