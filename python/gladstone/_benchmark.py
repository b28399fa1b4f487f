"""Scores of estimators on published cases."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal

import numpy as np

from . import _core
from ._errors import check_choice
from ._field import Field
from ._progress import Progress, reporting

Estimator = Callable[[np.ndarray, np.ndarray], Any]


class BenchmarkCase:
    """Image pair of 8 bits with a displacement that is known everywhere."""

    def __init__(self, name: str, *, device: str = "auto"):
        """Renders the case with this name; `benchmark_cases` lists all names."""
        self._core = _core.benchmark_case(name, device)

    @property
    def name(self) -> str:
        """Name of the case."""
        return self._core.name

    @property
    def description(self) -> str:
        """Displacement and noise of the images, in words."""
        return self._core.what

    @property
    def a(self) -> np.ndarray:
        """[rows, columns] first frame, uint8."""
        return self._core.images()[0]

    @property
    def b(self) -> np.ndarray:
        """[rows, columns] second frame, uint8."""
        return self._core.images()[1]

    def truth(self, x, y) -> np.ndarray:
        """Returns the true displacement [..., 2] at points (x, y). Each point is the midpoint between the positions of
        a particle in both frames [px]."""
        x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
        flat = self._core.truth(np.ascontiguousarray(x.ravel()), np.ascontiguousarray(y.ravel()))
        return flat.reshape(*x.shape, 2)

    def score(self, field) -> dict[str, float]:
        """Returns the error measures of a field, or of anything that `Field.of` accepts [px]."""
        return self._core.score(Field.of(field)._core)


def benchmark_cases() -> list[str]:
    """Returns the names of the published cases."""
    return _core.benchmark_cases()


def benchmark_estimators() -> list[str]:
    """Returns the names of gladstone's own estimators."""
    return _core.benchmark_estimators()


class Scores(list):
    """List of scores, one dictionary for each estimator and case. The keys are estimator, case, seconds and the error
    measures: `rms_px` of all valid vectors, `rms_without_gross_px` of the vectors with errors of at most 1 px, the
    number `gross` of vectors with larger errors, ..."""

    def to_pandas(self):
        """Returns a pandas.DataFrame with a row for each estimator and case."""
        import pandas

        return pandas.DataFrame(list(self))

    def table(self, measure: str = "rms_px") -> str:
        """Returns a text table of one measure, with a row for each case and a column for each estimator."""
        cases = list(dict.fromkeys(row["case"] for row in self))
        names = list(dict.fromkeys(row["estimator"] for row in self))
        values = {(row["case"], row["estimator"]): row.get(measure) for row in self}
        width = max([len(case) for case in cases] + [len(measure)])
        columns = [max(len(name), 9) for name in names]
        lines = [measure.ljust(width) + "".join("  " + n.rjust(w) for n, w in zip(names, columns))]
        for case in cases:
            cells = [values.get((case, name)) for name in names]
            shown = ["-" if value is None else f"{value:.5f}" for value in cells]
            lines.append(case.ljust(width) + "".join("  " + s.rjust(w) for s, w in zip(shown, columns)))
        return "\n".join(lines)

    def __str__(self) -> str:
        return "\n".join([
            "rms error without gross errors (above 1 px), as in gladstone's published table [px]",
            self.table("rms_without_gross_px"), "", "rms error of all valid vectors [px]", self.table(),
        ])  # fmt: skip


def benchmark(
    estimators: Mapping[str, Estimator] | None = None,
    *,
    cases: Iterable[str] | None = None,
    own: Iterable[str] = ("default",),
    at: Literal["mid", "a"] = "mid",
    device: str = "auto",
    progress: Progress = False,
) -> Scores:
    """Scores estimators of displacement on published cases.

    estimators: dictionary of functions by name. Each function takes two frames (uint8 [rows, columns]) and returns a
        `Field`, arrays (x, y, u, v) in px, or dense displacements [rows, columns, 2] or [2, rows, columns] at every
        pixel.
    cases: names of the cases; default: all.
    own: gladstone's estimators that are scored for comparison; `benchmark_estimators` lists them.
    at: position to which dense displacements refer: "mid" (midpoint of both images of a particle) or "a" (position in
        frame a, as for most optical-flow networks).

    Returns the scores, one row for each estimator and case. `print` shows two tables of rms errors in px: one without
    gross errors, one of all vectors.
    """
    check_choice("at", at, ("mid", "a"))
    if estimators is not None and not isinstance(estimators, Mapping):
        raise TypeError('estimators must be functions by name: {"mine": my_function}')
    own = list(own)
    for name in {*own} & {*(estimators or {})}:
        raise ValueError(f'"{name}" is also the name of an estimator of gladstone; choose another name')
    scores = Scores()
    names = list(cases) if cases is not None else benchmark_cases()
    with reporting(progress) as report:
        for number, name in enumerate(names):
            case = BenchmarkCase(name, device=device)
            for ours in own:
                field = Field._of(_core.benchmark_estimate(case._core, ours, device))
                scores.append({"estimator": ours, "case": name, "seconds": field.seconds, **case.score(field)})
            for theirs, estimate in (estimators or {}).items():
                start = time.perf_counter()
                given = estimate(case.a, case.b)
                seconds = time.perf_counter() - start
                field = _at_mid_positions(given, at)
                scores.append({"estimator": theirs, "case": name, "seconds": seconds, **case.score(field)})
            if report is not None:
                report(1, "benchmark", number + 1, len(names))
    return scores


def _at_mid_positions(given, at: str) -> Field:
    """Returns the field of an estimator; moves dense displacements of frame a to their mid-positions."""
    dense = not isinstance(given, (Field, tuple, list, str, os.PathLike)) and not hasattr(given, "data_vars")
    field = Field.of(given)
    if at == "mid" or not dense:
        return field
    return Field(field.x + field.u / 2, field.y + field.v / 2, field.u, field.v)
