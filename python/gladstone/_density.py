"""Reconstruction of density and its uncertainty from BOS vectors."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _core
from ._case import Case
from ._errors import check_choice, check_whole, hidden_folder
from ._measurement import Box, InputFolder, Measurement, place_of, reference_texts, vectors_place
from ._progress import Progress, reporting
from ._xarray import grid_variable
from ._setup import Setup


class Density(Measurement):
    """Density in the mid-plane of the medium, averaged over the thickness of the medium; for an axisymmetric flow, the
    density in the plane through the axis.

    Arrays are [rows, columns], read-only, with x to the right and y upwards: row 0 is the lowest. NaN: not determined.
    """

    @property
    def x_mm(self) -> np.ndarray:
        """[columns] position to the right of the optical axis [mm]."""
        return self._core.x_mm()

    @property
    def y_mm(self) -> np.ndarray:
        """[rows] position above the optical axis [mm]."""
        return self._core.y_mm()

    @property
    def density(self) -> np.ndarray:
        """Density [kg/m^3]."""
        return self._core.array("density")

    @property
    def sigma(self) -> np.ndarray:
        """Standard uncertainty of the density; includes the uncertainties of the vectors, the reference density and the
        scale [kg/m^3]."""
        return self._core.array("sigma")

    @property
    def sigma_random(self) -> np.ndarray:
        """Part of the uncertainty that is due to the vectors [kg/m^3]."""
        return self._core.array("sigma_random")

    @property
    def gradient(self) -> np.ndarray:
        """[rows, columns, 2] measured density gradient (d/dx, d/dy) [kg/m^4]; axisymmetric: computed from differences
        of the density."""
        return self._core.array("gradient")

    @property
    def region(self) -> np.ndarray:
        """Index of the connected region of valid vectors to which each node belongs; 0: the largest region; -1: no
        valid vector."""
        return self._core.array("region")

    @property
    def reference(self) -> np.ndarray:
        """True at nodes with the reference density."""
        return self._core.array("reference").astype(bool)

    @property
    def truth(self) -> np.ndarray | None:
        """True density [kg/m^3]; None unless the case was rendered."""
        return self._core.array("truth")

    @property
    def error(self) -> np.ndarray | None:
        """Density minus true density [kg/m^3]; None unless the case was rendered."""
        return None if self.truth is None else self.density - self.truth

    @property
    def summary(self) -> dict[str, Any]:
        """Results of `gladstone reconstruct --json`: ranges, errors against the truth, axis of symmetry."""
        return json.loads(self._core.summary())

    @property
    def budget(self) -> dict[str, dict[str, float]]:
        """Causes of the error by name, with bias and rms [kg/m^3]; empty unless requested by `budget=True`."""
        return self.summary.get("budget_kg_m3", {})

    def save(self, path: str | os.PathLike) -> None:
        """Writes density, uncertainty and gradient with their axes [mm], as `gladstone reconstruct` does: .h5, .nc,
        .vti, .mat or .csv."""
        self._core.save(os.fspath(path))

    def to_xarray(self):
        """Returns an xarray.Dataset over (y, x) in mm: density, sigma, sigma_random, region, reference, and for a
        rendered case truth and error."""
        import xarray

        variables = {
            "density": grid_variable(self.density, "kg m-3", "density"),
            "sigma": grid_variable(self.sigma, "kg m-3", "standard uncertainty of the density"),
            "sigma_random": grid_variable(self.sigma_random, "kg m-3", "standard uncertainty due to the vectors"),
            "region": grid_variable(self.region, "1", "connected region of valid vectors, -1: none"),
            "reference": grid_variable(self.reference, "1", "node with the reference density"),
        }
        if self.truth is not None:
            variables["truth"] = grid_variable(self.truth, "kg m-3", "true density")
            variables["error"] = grid_variable(self.error, "kg m-3", "density minus true density")
        return xarray.Dataset(
            variables,
            coords={
                "x": ("x", self.x_mm, {"units": "mm", "long_name": "position to the right of the optical axis"}),
                "y": ("y", self.y_mm, {"units": "mm", "long_name": "position above the optical axis"}),
            },
        )

    def plot(self):
        """Draws maps of density and uncertainty, and of the error for a rendered case. Returns a matplotlib figure."""
        from ._plot import plot_density

        return plot_density(self)

    def __repr__(self) -> str:
        rows, columns = self.density.shape
        return f"<gladstone.Density {columns} x {rows} nodes>"


def reconstruct(
    source,
    setup: Setup | Case | str | os.PathLike | None = None,
    *,
    reference: str | Box | Sequence[str | Box] | None = None,
    reference_density: float | None = None,
    reference_sigma: float = 0.0,
    scale_uncertainty: float = 0.0,
    method: str = "wls",
    overlap: float | None = None,
    deconvolve: float | None = None,
    axis: str | None = None,
    abel: str = "direct",
    lambda_: float | None = None,
    samples: int = 400,
    budget: bool = False,
    conventions: str | None = None,
    device: str = "auto",
    progress: Progress = False,
) -> Density:
    """Reconstructs density from BOS vectors, equal bit by bit to `gladstone reconstruct`.

    source: vectors [px]: a `Field`, the path of a file, or anything that `Field.of` accepts. Without `setup`: the path
        of a CASE folder that contains vectors, or a `Case`; a rendered `Case` is correlated with its own settings
        first.
    setup: a `Setup` of the experiment, the `Case` of the vectors, or the path of a setup or a CASE folder.
    reference: region of known density: "left", "right", "top", "bottom" ("left:3" for three columns), a box (x0, y0,
        x1, y1) in mm from the optical axis, or a list of these. Required unless `axis` is given.
    reference_density, reference_sigma: density in the reference region (default: the ambient density) and its standard
        uncertainty [kg/m^3].
    scale_uncertainty: combined relative standard uncertainty of magnification, Z_D, Gladstone-Dale constant, pixel
        pitch and thickness.
    method: integration, as `--method` of `gladstone reconstruct`: by default least squares weighted by the uncertainty
        of the vectors.
    overlap: overlap of the interrogation windows, from 0 to below 1; default: from the settings of the vectors.
    deconvolve: largest amplification by the compensation of the averaging over the aperture; None: no compensation.
    axis: Abel inversion of an axisymmetric flow: "vertical" or "horizontal", whose position is determined, or "x=1.5",
        "y=-2" in mm.
    abel, lambda_: Abel inversion, as `--abel` of `gladstone reconstruct`, and the parameter of a regularised one,
        default by cross-validation.
    samples: number of random samples, 10 to 100000, for the uncertainty of large grids.
    budget: splits the error of a rendered case into its causes.
    conventions: conventions of a file of vectors of another program.

    Raises `SetupError` if the options and the setup do not determine a density, and `DataError` for unsuitable vectors.
    """
    check_choice("method", method, _core.integration_methods())
    check_choice("abel", abel, _core.abel_methods())
    check_whole("samples", samples, 10, 100_000)
    inputs = InputFolder()
    folder = inputs.name
    with reporting(progress) as report, hidden_folder(folder):
        place = place_of(folder, source if setup is None else setup)
        vectors = "" if setup is None else vectors_place(folder, source)
        if isinstance(source, Case) and not source._core.folder:
            vectors = vectors_place(folder, source.correlate(device=device))
        core = _core.reconstruct(
            place, vectors, conventions, reference_texts(reference), reference_density, reference_sigma,
            scale_uncertainty, method, overlap, deconvolve, axis, abel, lambda_, samples, budget,
            device, report,
        )  # fmt: skip
    return Density(core, inputs)
