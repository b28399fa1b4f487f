"""Progress bars by tqdm, or lines on stderr without it."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Union

Progress = Union[bool, Callable[[str, int, int], None]]
"""True: a progress bar; False: none; a function (label, done, total): called at most ten times a second."""


class _Bars:
    """One bar for each computation that begins."""

    def __init__(self, tqdm):
        self._tqdm, self._number, self._bar = tqdm, 0, None

    def __call__(self, number: int, label: str, done: int, total: int) -> None:
        if number != self._number:
            self.close()
            self._number, self._bar = number, self._tqdm(desc=label, total=total, leave=False)
        self._bar.n = done
        self._bar.refresh()

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None


class _Lines:
    """A line for each computation, for installations without tqdm."""

    def __init__(self):
        self._number = 0

    def __call__(self, number: int, label: str, done: int, total: int) -> None:
        if number != self._number:
            self._number = number
            print(f"{label}: {total}", file=sys.stderr)

    def close(self) -> None:
        pass


class _Function:
    def __init__(self, function):
        self._function = function

    def __call__(self, number: int, label: str, done: int, total: int) -> None:
        self._function(label, done, total)

    def close(self) -> None:
        pass


class reporting:
    """Context manager whose value is the callback of the compiled part, or None."""

    def __init__(self, progress: Progress):
        self._sink = None
        if callable(progress):
            self._sink = _Function(progress)
        elif progress:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                self._sink = _Lines()
            else:
                self._sink = _Bars(tqdm)

    def __enter__(self):
        return self._sink

    def __exit__(self, *_):
        if self._sink is not None:
            self._sink.close()
