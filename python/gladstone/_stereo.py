"""Three components of displacement from the vectors of two cameras."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from . import _core
from ._case import Case
from ._errors import check_choice, hidden_folder
from ._measurement import InputFolder, Measurement, case_place, measured_case_place, vectors_place
from ._progress import Progress, reporting
from ._xarray import grid_variable


class ThreeComponents(Measurement):
    """Displacement along X, Y, Z of the world at the nodes of a grid on the laser sheet.

    Arrays are [rows, columns], with x to the right and y upwards: row 0 is the lowest. NaN: not determined.
    """

    @property
    def x_mm(self) -> np.ndarray:
        """[columns] X of the nodes [mm]."""
        return self._core.x_mm()

    @property
    def y_mm(self) -> np.ndarray:
        """[rows] Y of the nodes [mm]."""
        return self._core.y_mm()

    @property
    def displacement_mm(self) -> np.ndarray:
        """[rows, columns, 3] displacement u, v, w from frame a to frame b [mm]."""
        return self._core.array("displacement")

    @property
    def sigma_mm(self) -> np.ndarray:
        """[rows, columns, 3] standard uncertainty of u, v, w [mm]; NaN: vectors without uncertainty."""
        return self._core.array("sigma")

    @property
    def covariance_mm2(self) -> np.ndarray:
        """[rows, columns, 6] covariance uu, vv, ww, uv, uw, vw [mm^2]."""
        return self._core.array("covariance")

    @property
    def u(self) -> np.ndarray:
        """Displacement along X [mm]."""
        return self.displacement_mm[..., 0]

    @property
    def v(self) -> np.ndarray:
        """Displacement along Y [mm]."""
        return self.displacement_mm[..., 1]

    @property
    def w(self) -> np.ndarray:
        """Displacement along Z [mm]."""
        return self.displacement_mm[..., 2]

    @property
    def residual_px(self) -> np.ndarray:
        """Root of the sum of squares of the residuals of the four equations [px]."""
        return self._core.array("residual")

    @property
    def residual_ratio(self) -> np.ndarray:
        """Residual divided by its standard uncertainty; NaN: vectors without uncertainty."""
        return self._core.array("residual_ratio")

    @property
    def valid(self) -> np.ndarray:
        """True at nodes with a displacement whose residual is within its limit."""
        return self._core.array("valid") == 1.0

    @property
    def truth_mm(self) -> np.ndarray | None:
        """[rows, columns, 3] true displacement [mm]; None unless both cameras belong to one rendering."""
        return self._core.array("truth")

    @property
    def error_mm(self) -> np.ndarray | None:
        """[rows, columns, 3] displacement minus true displacement [mm]; None without true displacement."""
        return None if self.truth_mm is None else self.displacement_mm - self.truth_mm

    @property
    def summary(self) -> dict[str, Any]:
        """Results of `gladstone stereo --json`: means, uncertainties, errors against the truth, laser sheet."""
        return json.loads(self._core.summary())

    def save(self, path: str | os.PathLike) -> None:
        """Writes the file of `gladstone stereo`, which `gladstone convert` converts to other formats."""
        self._core.save(os.fspath(path))

    def to_xarray(self):
        """Returns an xarray.Dataset over (y, x) in mm: u, v, w, sigma_u, sigma_v, sigma_w, residual, residual_ratio,
        valid, and for two cameras of one rendering truth_u, truth_v, truth_w."""
        import xarray

        variables = {}
        for k, name in enumerate("uvw"):
            variables[name] = grid_variable(self.displacement_mm[..., k], "mm", f"displacement along {'xyz'[k]}")
            variables[f"sigma_{name}"] = grid_variable(self.sigma_mm[..., k], "mm", f"standard uncertainty of {name}")
            if self.truth_mm is not None:
                variables[f"truth_{name}"] = grid_variable(self.truth_mm[..., k], "mm", f"true {name}")
        variables["residual"] = grid_variable(self.residual_px, "px", "residual of the four equations")
        variables["residual_ratio"] = grid_variable(self.residual_ratio, "1", "residual over its standard uncertainty")
        variables["valid"] = grid_variable(self.valid, "1", "residual within its limit")
        return xarray.Dataset(
            variables,
            coords={
                "x": ("x", self.x_mm, {"units": "mm", "long_name": "X of the world"}),
                "y": ("y", self.y_mm, {"units": "mm", "long_name": "Y of the world"}),
            },
        )

    def plot(self):
        """Draws maps of u, v and w [mm] at valid nodes, and of the residual [px]. Returns a matplotlib figure."""
        from ._plot import plot_three_components

        return plot_three_components(self)

    def __repr__(self) -> str:
        rows, columns = self.valid.shape
        return f"<gladstone.ThreeComponents {columns} x {rows} nodes, {int(self.valid.sum())} valid>"


def _input(folder: str, name: str, source, dewarp: str, device: str) -> str:
    """Returns the CASE folder or the file of vectors of one camera; data in memory are written into `folder`."""
    if not isinstance(source, Case):
        return vectors_place(folder, source, name)
    return measured_case_place(folder, source, name, device) if dewarp == "vectors" else case_place(folder, source, name)


def stereo(
    first,
    second=None,
    *,
    calibrations: Sequence[str | os.PathLike] | None = None,
    sheet_z_mm: float = 0.0,
    sheet_slope: Sequence[float] = (0.0, 0.0),
    align: bool = False,
    images: Sequence[str | os.PathLike] = (),
    dewarp: Literal["vectors", "images"] = "vectors",
    spacing_mm: float | None = None,
    window_px: float | None = None,
    residual_limit: float = 4.0,
    conventions: str | None = None,
    device: str = "auto",
    progress: Progress = False,
) -> ThreeComponents:
    """Combines the vectors of two cameras to three components, equal bit by bit to `gladstone stereo`.

    first, second: for each camera a `Case` (rendered: correlated with its own settings), the path of a CASE folder with
        its vectors or of a file of vectors, a `Field`, or anything that `Field.of` accepts [px]. Without `second`: the
        cases of two cameras by name, as `Setup.render` returns them, or the path of their common folder.
    calibrations: calibration.h5 of both cameras; required for vectors without a case. Default: the exact cameras.
    sheet_z_mm, sheet_slope: Z of the middle of the laser sheet at X = Y = 0 [mm], and its slopes dZ/dX and dZ/dY.
    align: determines the position of the laser sheet from the disparity between the images of both cameras; sheet_z_mm
        and sheet_slope are the initial values.
    images: images for the disparity, alternately of the first and of the second camera; default: the frames of the
        cases.
    dewarp: "vectors" combines vectors of the original images; "images" first dewarps the frames of the cases and
        correlates the dewarped frames.
    spacing_mm: distance between the nodes [mm]; None: mean distance of the vectors.
    window_px: size of the interrogation windows [px], from which the correlation between the errors of neighbouring
        vectors is computed; 0: independent errors; None: the last window of the correlation.
    residual_limit: largest residual of a valid vector, in standard uncertainties; 0: all vectors are accepted.
    conventions: conventions of files of vectors of another program.

    Raises `SetupError` for invalid options, and `DataError` for files that are missing or do not fit together.
    """
    check_choice("dewarp", dewarp, ("vectors", "images"))
    if second is None and isinstance(first, Mapping):
        if len(first) != 2:
            raise ValueError(f"expected the cases of two cameras, got {len(first)}")
        first, second = first.values()
    inputs = InputFolder()
    with reporting(progress) as report, hidden_folder(inputs.name):
        if second is None:
            places = [os.fspath(first), ""]
        else:
            places = [_input(inputs.name, name, source, dewarp, device)
                      for name, source in (("first", first), ("second", second))]  # fmt: skip
        core = _core.stereo(
            *places, [os.fspath(path) for path in calibrations or ()], conventions, sheet_z_mm,
            (float(sheet_slope[0]), float(sheet_slope[1])), align, [os.fspath(path) for path in images],
            dewarp == "images", spacing_mm or 0.0, window_px, residual_limit, device, report,
        )  # fmt: skip
    return ThreeComponents(core, inputs)
