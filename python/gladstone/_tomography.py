"""Reconstruction of the density of a volume from the displacement in a few views."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _core
from ._case import Case
from ._errors import check_whole, hidden_folder
from ._measurement import Box, InputFolder, Measurement, measured_case_place, place_of, reference_texts, vectors_place
from ._progress import Progress, reporting
from ._setup import Setup
from ._xarray import volume_variable


class Tomography(Measurement):
    """Density of a volume. Arrays are [z, y, x], read-only, with ascending coordinates in the frame of the volume."""

    @property
    def x_mm(self) -> np.ndarray:
        """[nx] positions of the nodes along X [mm]."""
        return self._core.axis_mm(0)

    @property
    def y_mm(self) -> np.ndarray:
        """[ny] positions of the nodes along Y [mm]."""
        return self._core.axis_mm(1)

    @property
    def z_mm(self) -> np.ndarray:
        """[nz] positions of the nodes along Z [mm]."""
        return self._core.axis_mm(2)

    @property
    def density(self) -> np.ndarray:
        """Reconstructed density [kg/m^3]; equals the reference density at nodes that no view sees."""
        return self._core.array("density")

    @property
    def views(self) -> np.ndarray:
        """Number of views with a line of sight through a cell adjacent to each node."""
        return self._core.array("views")

    @property
    def truth(self) -> np.ndarray | None:
        """True density of rendered cases [kg/m^3]."""
        return self._core.array("truth")

    @property
    def error(self) -> np.ndarray | None:
        """Density minus true density of rendered cases [kg/m^3]."""
        return None if self.truth is None else self.density - self.truth

    @property
    def summary(self) -> dict[str, Any]:
        """Results of `gladstone tomography --json`, with `relative_error` for rendered cases."""
        return json.loads(self._core.summary())

    def save(self, path: str | os.PathLike) -> None:
        """Writes the density and its axes [mm], as `gladstone tomography` does: .h5, .nc, .vti, .mat or .csv, each of
        which can be the field of a setup."""
        self._core.save(os.fspath(path))

    def to_xarray(self):
        """Returns an xarray.Dataset over (z, y, x) in mm: density and views, and for rendered cases truth and error."""
        import xarray

        variables = {
            "density": volume_variable(self.density, "kg m-3", "density"),
            "views": volume_variable(self.views, "1", "number of views with a line of sight through the node"),
        }
        if self.truth is not None:
            variables["truth"] = volume_variable(self.truth, "kg m-3", "true density")
            variables["error"] = volume_variable(self.error, "kg m-3", "density minus true density")
        coordinates = {
            name: (name, values, {"units": "mm", "long_name": f"{name.upper()} of the volume"})
            for name, values in (("x", self.x_mm), ("y", self.y_mm), ("z", self.z_mm))
        }
        return xarray.Dataset(variables, coords=coordinates)

    def plot(self):
        """Draws the density in the three mid-planes [kg/m^3], and for rendered cases its error below.

        Returns a matplotlib figure.
        """
        from ._plot import plot_volume

        return plot_volume(self)

    def __repr__(self) -> str:
        nz, ny, nx = self.density.shape
        return f"<gladstone.Tomography {nx} x {ny} x {nz} nodes>"


def tomography(
    cases: Sequence[Case | Setup | str | os.PathLike],
    vectors: Sequence = (),
    *,
    reference: str | Box | Sequence[str | Box] | None = None,
    angles_deg: Sequence[float] = (),
    arc_deg: float = 180.0,
    reference_density: float | None = None,
    bounds_mm: Sequence[float] | None = None,
    spacing_mm: float | None = None,
    support: str | None = None,
    least_density: float = 0.0,
    largest_density: float | None = None,
    iterations: int = 100,
    tolerance: float = 0.001,
    relaxation: float = 0.5,
    tv_weight: float | None = None,
    ray_truth: bool = False,
    conventions: str | None = None,
    device: str = "auto",
    progress: Progress = False,
) -> Tomography:
    """Reconstructs the density of a volume from BOS vectors of 3 to 16 views, equal bit by bit to `gladstone
    tomography`.

    cases: for each view a `Case` (rendered: correlated with its own settings) or the path of a CASE folder with its
        vectors; with `vectors` also a `Setup` or its path.
    vectors: for each view a `Field`, the path of a file, or anything that `Field.of` accepts [px]; empty: those of the
        cases.
    reference: region of the views whose lines of sight meet the reference density only: "left", "right", "top",
        "bottom" ("left:3" for three columns), a box (x0, y0, x1, y1) in mm, or a list of these. Required.
    angles_deg: angle by which the volume is turned about Y in each view; empty: view i has the angle `arc_deg` times i
        / views.
    reference_density: density in the reference region and outside of the volume [kg/m^3]; default: the ambient density.
    bounds_mm: corners (x0, y0, z0, x1, y1, z1) of the volume; None: the part that is visible in all views.
    spacing_mm: distance between the nodes; None: the distance between the vectors.
    support: "sphere:MM" or "cylinder:MM", outside of which the density is the reference density.
    least_density, largest_density: bounds of the density [kg/m^3].
    iterations, tolerance: largest number of sweeps over all views; the last one changes the volume by less than this
        fraction of its norm.
    relaxation: fraction of each correction that is applied.
    tv_weight: strength of the total variation relative to the largest density difference; None: the rms change of a
        node by the views in each sweep.
    ray_truth: uses the true displacement of the dots of rendered cases.
    conventions: conventions of files of vectors of another program.
    device: "cpu", "cuda", or "auto": the GPU if one is usable.

    Raises `SetupError` for invalid options, and `DataError` for views that do not determine a volume.
    """
    if bounds_mm is not None and len(bounds_mm) != 6:
        raise ValueError(f"bounds_mm must be six numbers, got {len(bounds_mm)}")
    inputs = InputFolder()

    def place(i: int, case: Case | Setup | str | os.PathLike) -> str:
        measured = isinstance(case, Case) and not vectors and not ray_truth
        name = f"case_{i}"
        return measured_case_place(inputs.name, case, name, device) if measured else place_of(inputs.name, case, name)

    with reporting(progress) as report, hidden_folder(inputs.name):
        places = [place(i, case) for i, case in enumerate(cases)]
        files = [vectors_place(inputs.name, one, f"vectors_{i}") for i, one in enumerate(vectors)]
        core = _core.tomography(
            places, files, conventions, ray_truth,
            [float(angle) for angle in angles_deg], arc_deg, reference_texts(reference), reference_density,
            [] if bounds_mm is None else [float(bound) for bound in bounds_mm], spacing_mm, support, least_density,
            largest_density, iterations, tolerance, relaxation, tv_weight, device, report,
        )  # fmt: skip
    return Tomography(core, inputs)


def tomography_setups(
    setup: Setup | str | os.PathLike, folder: str | os.PathLike, *, views: int = 8, arc_deg: float = 180.0
) -> list[str]:
    """Writes setups of several views of one field, in which the field is turned about Y. The files are equal to those
    of `gladstone tomography --views`.

    setup: a `Setup` or its path, with a field of finite extent.
    folder: folder to which view_00.toml, view_01.toml, ... and the turned fields view_00.h5, ... are written.
    views, arc_deg: number of views, 3 to 16; view i has the angle `arc_deg` times i / views.

    Returns the paths of the setups. Render each of them, and give the cases to `tomography`.
    Raises `SetupError` for invalid options, and for setups without a field of finite extent.
    """
    check_whole("views", views, 3, 16)
    os.makedirs(folder, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary, hidden_folder(temporary):
        return _core.tomography_setups(place_of(temporary, setup), views, arc_deg, os.fspath(folder))


def reconstruct_lines(
    origin_mm,
    direction,
    value,
    view,
    *,
    nodes: tuple[int, int, int],
    spacing_mm: float,
    center_mm: tuple[float, float, float] = (0.0, 0.0, 0.0),
    bounds: tuple[float, float] = (-np.inf, np.inf),
    iterations: int = 100,
    tolerance: float = 0.001,
    relaxation: float = 0.5,
    tv_weight: float | None = None,
    device: str = "auto",
    progress: Progress = False,
) -> np.ndarray:
    """Reconstructs a volume from line integrals along parallel lines of sight, by the algorithm of `tomography`.

    origin_mm, direction: [lines, 3] a point of each line [mm], and its direction of any length.
    value: [lines] line integral of a quantity [its unit times m]; NaN: not measured.
    view: [lines] index of the view, ascending from 0.
    nodes, spacing_mm, center_mm: number of nodes along x, y and z, their distance, and the centre of the volume.
    bounds: smallest and largest value of the volume; the interval must contain 0.

    Returns [nz, ny, nx] values. Raises `SetupError` for settings, and `DataError` for lines.
    """
    def number_array(values, columns: int):
        array = np.ascontiguousarray(values, dtype=np.float64)
        return array.reshape(-1, columns) if columns > 1 else array.ravel()

    with reporting(progress) as report:
        return _core.reconstruct_lines(
            number_array(origin_mm, 3), number_array(direction, 3), number_array(value, 1), number_array(view, 1),
            tuple(nodes), spacing_mm, tuple(center_mm), *bounds, iterations, tolerance,
            relaxation, tv_weight, device, report,
        )  # fmt: skip
