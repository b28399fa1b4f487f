"""Threads of parallel work."""

from __future__ import annotations

from . import _core
from ._errors import check_whole


def set_threads(threads: int) -> None:
    """Sets the number of threads of parallel work, at most 4096; 0: all cores."""
    check_whole("threads", threads, 0, 4096)
    _core.set_threads(threads)


def threads() -> int:
    """Returns the number of threads of parallel work."""
    return _core.threads()
