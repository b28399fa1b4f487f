"""Comparison of measured vectors with truth and theory."""

from __future__ import annotations

import json
import os
import tempfile
from typing import Any

import numpy as np

from . import _core
from ._errors import OutputError, WarningText, hidden_folder


def check_report_ending(path: str) -> None:
    """Raises OutputError unless a file name has the ending of a report."""
    if not path.endswith((".html", ".htm", ".md")):
        raise OutputError(path, "is not the name of a report: it must end in .html or .md")


class Report:
    """Errors of measured vectors, and the causes of these errors.

    Arrays have the shape of the vectors, with a last axis for the components (u to the right, v downwards) in px.
    """

    def __init__(self, core: _core.Comparison, case, field):
        self._core, self._case, self._field = core, case, field
        self._errors: dict[str, Any] | None = None

    @property
    def errors(self) -> dict[str, Any]:
        """Contents of errors.json: error measures against ray truth, theory and truth averaged over the window, and the
        error budget."""
        if self._errors is None:
            self._errors = json.loads(self._core.errors())
        return self._errors

    @property
    def rms_px(self) -> float:
        """Rms error against the ray truth, per component [px]."""
        return self.errors["ray_truth"]["rms_px"]

    @property
    def bias_px(self) -> tuple[float, float]:
        """Mean error against the ray truth (u, v) [px]."""
        truth = self.errors["ray_truth"]
        return truth["bias_u_px"], truth["bias_v_px"]

    @property
    def random_px(self) -> tuple[float, float]:
        """Standard deviation of the error against the ray truth (u, v) [px]."""
        truth = self.errors["ray_truth"]
        return truth["random_u_px"], truth["random_v_px"]

    @property
    def budget(self) -> dict[str, dict[str, float]]:
        """Terms of the error budget by name: bias_u_px, bias_v_px, random_u_px, random_v_px, rms_px."""
        return self.errors["budget"]["terms"]

    @property
    def warnings(self) -> list[WarningText]:
        """Warnings about the comparison."""
        return self._core.warnings

    def _vectors(self, name: str) -> np.ndarray | None:
        array = self._core.array(name)
        return None if array is None else array.reshape(*self.shape, 2)

    @property
    def shape(self) -> tuple[int, ...]:
        """(rows, columns) of the vectors; (N,) if they are scattered."""
        if self._core.columns > 0:
            return self._core.rows, self._core.columns
        return (len(self._core.array("mask")),)

    @property
    def mask(self) -> np.ndarray:
        """True for the vectors that are compared."""
        return self._core.array("mask").reshape(self.shape).astype(bool)

    @property
    def position_px(self) -> np.ndarray:
        """Positions of the vectors (column, row)."""
        return self._vectors("position_px")

    @property
    def measured_px(self) -> np.ndarray:
        """Measured displacements."""
        return self._vectors("measured_px")

    @property
    def truth_px(self) -> np.ndarray:
        """True displacements at the positions of the vectors, by ray tracing."""
        return self._vectors("truth_px")

    @property
    def window_truth_px(self) -> np.ndarray:
        """True displacements averaged over the interrogation windows."""
        return self._vectors("window_truth_px")

    @property
    def eq9_px(self) -> np.ndarray | None:
        """Displacements by the small-angle theory, Eq. 9. BOS only."""
        return self._vectors("eq9_px")

    @property
    def eq9_cone_px(self) -> np.ndarray | None:
        """Displacements by the aperture-averaged theory: Eq. 9 averaged over dot and aperture. BOS only."""
        return self._vectors("eq9_cone_px")

    @property
    def flow_px(self) -> np.ndarray | None:
        """Displacements of the particles by the flow, without refraction. PIV only."""
        return self._vectors("flow_px")

    @property
    def error_px(self) -> np.ndarray:
        """Measured minus true displacements; NaN where vectors are not compared."""
        return np.where(self.mask[..., np.newaxis], self.measured_px - self.truth_px, np.nan)

    def plot(self):
        """Draws maps of truth, measurement and error, and the error budget. Returns a matplotlib figure."""
        from ._plot import plot_report

        return plot_report(self)

    def draw(self, folder: str | os.PathLike, format: str = "png") -> list[str]:
        """Draws the figures of `gladstone compare` into an existing folder by gnuplot. Returns their paths."""
        return self._core.draw(os.fspath(folder), format)

    def to_html(self, path: str | os.PathLike = "report.html", *, device: str = "auto") -> str:
        """Writes the report of `gladstone report`, one HTML file that works offline. Returns the findings as text.

        The comparison is computed again for this report.
        """
        check_report_ending(os.fspath(path))
        with tempfile.TemporaryDirectory() as folder, hidden_folder(folder):
            place = os.path.join(folder, "case")
            self._case.save(place)
            self._field.save(os.path.join(place, "vectors.h5"))
            output = os.path.abspath(os.fspath(path))
            return _core.report(place, output, "", [], "", "", "png", device, None)

    def __reduce__(self):
        raise TypeError("a Report cannot be pickled; pickle its errors (a dictionary) or its arrays")

    def __str__(self) -> str:
        return self._core.text()

    def __repr__(self) -> str:
        return f"<gladstone.Report rms {self.rms_px:.4g} px over {int(np.sum(self.mask))} vectors>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{name}</td>" + "".join(f"<td>{_number(term[key])}</td>" for key in _COLUMNS) + "</tr>"
            for name, term in {**self.budget, "total": self.errors["budget"]["total"]}.items()
        )
        head = "".join(f"<th>{column.replace('_px', '').replace('_', ' ')} [px]</th>" for column in _COLUMNS)
        return f"<table><tr><th>error budget</th>{head}</tr>{rows}</table>"


_COLUMNS = ("bias_u_px", "bias_v_px", "random_u_px", "random_v_px", "rms_px")


def _number(value: float | None) -> str:
    return "unknown" if value is None else f"{value:.5f}"
