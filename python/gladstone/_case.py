"""Rendered image pairs with known displacement."""

from __future__ import annotations

import json
import os
from typing import Any, Literal, NamedTuple

import numpy as np

from . import _core
from ._errors import check_choice, check_whole
from ._correlate import correlate
from ._field import Field
from ._progress import Progress, reporting
from ._report import Report
from ._setup import Setup


class Accuracy(NamedTuple):
    """Standard errors of the true displacements and of the images, estimated from the scatter of the rays."""

    rms_px: float
    """Rms of the standard error of the displacement, over dots and components [px]; NaN: unknown."""
    largest_px: float
    """Largest error of a component [px]."""
    worst: int
    """Index of the dot or particle with the largest error."""
    above: int
    """Number of dots with an error above 0.001 px."""
    unknown: int
    """Number of visible dots whose error is unknown, since too few rays reached the sensor."""
    image_error_levels: float
    """Rms error of the grey levels of lit pixels [grey levels at 12 bits, or at the camera's bit depth if that is
    lower]; NaN: not measured (``render.rays_per_dot`` is a number, or the deflection table was used)."""


class Truth:
    """True positions and displacements of the dots or particles of a case. Arrays are read-only views.

    Pixel coordinates: column x to the right, row y downwards, from 0 at the centre of the first pixel. Displacements
    are those from frame a to frame b, u to the right and v downwards. NaN: no light of the dot or particle reaches the
    sensor.
    """

    def __init__(self, core: _core.PairCase):
        self._core = core
        self._flows: dict[tuple[str, int, bool], np.ndarray] = {}

    def _array(self, name: str) -> np.ndarray:
        array = self._optional(name)
        return np.empty((0, 2)) if array is None else array

    def _optional(self, name: str) -> np.ndarray | None:
        return _core.truth_array(self._core, name)

    def __len__(self) -> int:
        return len(self._array("position_m"))

    @property
    def position_m(self) -> np.ndarray:
        """[N, 3] world position in frame a [m]."""
        return self._array("position_m")

    @property
    def position_px(self) -> np.ndarray:
        """[N, 2] position of the image in frame a [px]."""
        return self._array("reference_px")

    @property
    def displacement_px(self) -> np.ndarray:
        """[N, 2] displacement by ray tracing [px]."""
        return self._array("displacement_px")

    @property
    def error_px(self) -> np.ndarray:
        """[N, 2] standard error of the displacement [px]; NaN: unknown."""
        return self._array("displacement_error_px")

    @property
    def std_px(self) -> np.ndarray:
        """[N, 2] standard deviation of the ray hits in frame b [px]."""
        return self._array("displacement_std_px")

    @property
    def flux(self) -> np.ndarray:
        """[N, 2] light of each dot or particle in frames a and b. Unit for BOS: light of a fully lit pixel; for PIV:
        photons."""
        return self._array("flux")

    @property
    def rays(self) -> np.ndarray:
        """[N, 2] number of rays that reached the sensor in frames a and b."""
        return self._array("rays")

    @property
    def rays_planned(self) -> np.ndarray:
        """[N] number of rays that were traced in each frame."""
        return self._array("rays_planned")

    @property
    def eq9_px(self) -> np.ndarray | None:
        """[N, 2] displacement by the small-angle theory, Eq. 9 of Rajendran et al. (2019) [px]. BOS only."""
        return None if self._core.is_piv else self._optional("eq9_px")

    @property
    def eq9_cone_px(self) -> np.ndarray | None:
        """[N, 2] displacement by the aperture-averaged theory: Eq. 9 averaged over dot and aperture [px]. BOS only."""
        return None if self._core.is_piv else self._optional("eq9_cone_px")

    @property
    def second_m(self) -> np.ndarray | None:
        """[N, 3] position at the second pulse [m]. PIV only."""
        return self._optional("second_m")

    @property
    def diameter_m(self) -> np.ndarray | None:
        """[N] diameter of the particles [m]. PIV only."""
        return self._optional("diameter_m")

    @property
    def displacement_ambient_px(self) -> np.ndarray | None:
        """[N, 2] displacement without the refractive medium [px]. PIV only."""
        return self._optional("displacement_ambient_px")

    def flow(
        self,
        at: Literal["mid", "a"] = "mid",
        *,
        spacing_px: int = 1,
        exact: bool = False,
        device: str = "auto",
        progress: Progress = False,
    ) -> np.ndarray:
        """Computes the true displacement at every pixel, independently of the dots or particles of the case.

        at: "a": displacement of the object point whose image in frame a is at the pixel, the convention of optical-flow
            networks; "mid": displacement of the object point whose images in both frames have the pixel as their
            midpoint, the convention of correlation with symmetric window deformation.
        spacing_px: distance of the computed columns and rows [px].
        exact: traces rays to every computed pixel instead of interpolating, which takes up to 16 times as long (35
            instead of 4.4 s of processor time for 256 x 256 px of a BOS case). The value of each pixel is then
            independent of the other pixels.

        Returns [rows, columns, 2] in px. By default, rays are traced to every fourth column and row, and to all pixels
        around which the displacement deviates from its cubic interpolation over 8 px by more than 5e-4 px and four
        standard errors. The other pixels are interpolated from these, over at most 4 px, so that features below 4 px
        can be missed. The result is stored, so that a repeated call with the same arguments returns at once.
        """
        check_choice("at", at, ("mid", "a"))
        check_whole("spacing_px", spacing_px, 1, 10_000)
        choice = (at, spacing_px, exact)
        if choice not in self._flows:
            with reporting(progress) as report:
                self._flows[choice] = _core.flow(self._core, at == "a", spacing_px, exact, device, report)
        return self._flows[choice].copy()

    def save(
        self,
        path: str | os.PathLike,
        at: Literal["mid", "a"] = "mid",
        *,
        spacing_px: int | None = None,
        exact: bool = False,
        device: str = "auto",
        progress: Progress = False,
    ) -> None:
        """Writes true displacements in the format that the ending of `path` selects, as `Field.save` does.

        spacing_px: distance between the columns and rows at which the displacement is computed, as for `flow` [px].
            Default: 1 for .nc and .vti, which store grids; otherwise the displacements of the dots or particles, at
            their positions in frame a and with their standard errors as uncertainty.
        exact: traces rays to every pixel, as for `flow`; the default spacing is then 1 for all formats.
        """
        if spacing_px is None and (exact or os.fspath(path).endswith((".nc", ".vti"))):
            spacing_px = 1
        if spacing_px is None:
            columns = [self.position_px, self.displacement_px, self.error_px]
            field = Field(*(values[:, i] for values in columns for i in range(2)))
        else:
            field = Field.from_dense(
                self.flow(at, spacing_px=spacing_px, exact=exact, device=device, progress=progress), spacing_px
            )
        field.save(path)

    def __repr__(self) -> str:
        return f"<gladstone.Truth of {len(self)} sources>"


class Case:
    """Image pair of one camera, with the true displacements."""

    def __init__(self, core: _core.PairCase):
        self._core = core
        self._truth = Truth(core)

    @classmethod
    def load(cls, folder: str | os.PathLike) -> Case:
        """Loads a CASE folder, as written by `save` or `gladstone render`."""
        return cls(_core.PairCase.load(os.fspath(folder)))

    def __reduce__(self):
        if not self._core.folder:
            raise TypeError("a rendered case cannot be pickled; save it, and pickle Case.load(folder), or its arrays")
        return Case.load, (os.path.abspath(self._core.folder),)

    @property
    def images(self) -> np.ndarray:
        """[2, rows, columns] grey levels of both frames, uint16."""
        return self._core.images()

    @property
    def a(self) -> np.ndarray:
        """[rows, columns] first frame, uint16. BOS: the reference image."""
        return self.images[0]

    @property
    def b(self) -> np.ndarray:
        """[rows, columns] second frame, uint16. BOS: the measurement image."""
        return self.images[1]

    @property
    def truth(self) -> Truth:
        """True positions and displacements."""
        return self._truth

    @property
    def accuracy(self) -> Accuracy:
        """Standard error of the true displacements."""
        return Accuracy(**self._core.accuracy())

    @property
    def summary(self) -> dict[str, Any]:
        """Contents of summary.json: magnification, exposure, rays, warnings and more."""
        return json.loads(self._core.summary())

    @property
    def is_piv(self) -> bool:
        """True for PIV, False for BOS."""
        return self._core.is_piv

    @property
    def setup(self) -> Setup:
        """Setup with all keys: defaults are included, and every "auto" is replaced by the value that was used."""
        return Setup(self._core.resolved())

    def correlate(self, **settings) -> Field:
        """Measures the displacement with the settings of the case's own [correlate] table; see `correlate`."""
        own = self.setup.to_dict().get("correlate", {})
        if "window" in settings:
            own.pop("window_px", None)
        return correlate(self.a, self.b, **{**own, **settings})

    def compare(
        self, field, *, truth_at: Literal["mid", "a"] = "mid", device: str = "auto", progress: Progress = False
    ) -> Report:
        """Compares measured vectors with truth and theory.

        field: a `Field`, or anything that `Field.of` accepts [px].
        truth_at: position to which the displacement of a dot belongs: "mid" (midway between both frames, symmetric
            estimators) or "a" (in frame a, one-sided estimators).
        """
        check_choice("truth_at", truth_at, ("mid", "a"))
        field = Field.of(field)
        with reporting(progress) as report:
            compared = _core.compare(self._core, field._core, truth_at == "a", device, report)
        return Report(compared, self, field)

    def save(self, folder: str | os.PathLike) -> None:
        """Writes the CASE folder: reference.tif, flow.tif, truth.h5, setup.toml, summary.json."""
        self._core.save(os.fspath(folder))

    def plot(self):
        """Draws both images. Returns a matplotlib figure."""
        from ._plot import plot_images

        return plot_images(self)

    def __repr__(self) -> str:
        _, rows, columns = self.images.shape
        return f"<gladstone.Case {'PIV' if self.is_piv else 'BOS'}, {columns} x {rows} px, {len(self.truth)} sources>"
