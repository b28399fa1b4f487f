"""Progress bars by tqdm; without tqdm, lines on stderr."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from typing import Any, Union

Progress = Union[bool, Callable[[str, int, int], None]]
"""True: progress bar; False: no report of progress; a function (label, done, total): called at most ten times a
second."""


class _Bars:
    """Progress report with one bar for each computation."""

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
    """Progress report with one line for each computation, for installations without tqdm."""

    def __init__(self):
        self._number = 0

    def __call__(self, number: int, label: str, done: int, total: int) -> None:
        if number != self._number:
            self._number = number
            print(f"{label}: {total}", file=sys.stderr)


@contextmanager
def reporting(progress: Progress) -> Iterator[Callable[[int, str, int, int], Any] | None]:
    """Context manager whose value is the callback of the compiled part, or None.

    The callback takes the number of the computation, from 1, its label, and the steps done and in total.
    """
    if callable(progress):
        yield lambda number, label, done, total: progress(label, done, total)
        return
    if not progress:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        tqdm = None
    if tqdm is None:
        yield _Lines()
        return
    with closing(_Bars(tqdm)) as bars:
        yield bars
