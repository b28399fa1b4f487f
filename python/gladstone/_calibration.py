"""Camera calibration from images of a dot grid."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from . import _core
from ._errors import hidden_folder
from ._measurement import Measurement, place_of
from ._progress import Progress, reporting
from ._setup import Setup


class Calibration(Measurement):
    """Pinhole camera with distortion, and polynomial camera model, fitted to the dots of several planes."""

    @property
    def camera_matrix(self) -> np.ndarray:
        """[3, 3] OpenCV's camera matrix [px]."""
        fx, fy, cx, cy = self._core.array("pinhole")[:4]
        return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])

    @property
    def distortion(self) -> np.ndarray:
        """[4] OpenCV's distortion k1, k2, p1, p2."""
        return self._core.array("pinhole")[4:8]

    @property
    def rvec(self) -> np.ndarray:
        """[3] OpenCV's rotation vector from world to camera [rad]."""
        return self._core.array("pinhole")[8:11]

    @property
    def tvec(self) -> np.ndarray:
        """[3] OpenCV's translation from world to camera [m]."""
        return self._core.array("pinhole")[11:14]

    @property
    def standard_error(self) -> np.ndarray:
        """[14] standard errors of fx, fy, cx, cy, k1, k2, p1, p2, rvec, tvec, in the units of these parameters."""
        return self._core.array("standard_error")

    @property
    def world_m(self) -> np.ndarray:
        """[N, 3] world positions of the dots [m]."""
        return self._core.array("world_m")

    @property
    def pixel(self) -> np.ndarray:
        """[N, 2] measured positions of the dot images [px]."""
        return self._core.array("pixel")

    @property
    def residual_px(self) -> np.ndarray:
        """[N, 2] measured minus fitted position, for the pinhole camera [px]."""
        return self._core.array("residual_px")

    @property
    def plane_of(self) -> np.ndarray:
        """[N] index of the plane of each dot, from 0."""
        return self._core.array("plane_of")

    @property
    def results(self) -> dict[str, Any]:
        """All results, as `gladstone calibrate --json` prints them."""
        return json.loads(self._core.json())

    def save(self, path: str | os.PathLike) -> None:
        """Writes calibration.h5."""
        self._core.save(os.fspath(path))

    def draw(self, path: str | os.PathLike) -> None:
        """Draws the residuals by gnuplot (.png, .svg)."""
        self._core.draw(os.fspath(path))

    def __repr__(self) -> str:
        rms = float(np.sqrt(np.mean(self.residual_px**2)))
        return f"<gladstone.Calibration {len(self.pixel)} dots, rms {rms:.4g} px>"


def calibrate(given, images: Iterable[str | os.PathLike] = (), *, progress: Progress = False) -> Calibration:
    """Fits a camera to images of a dot grid in several planes.

    given: a `CalibrationCase`, or its CASE folder; or, with `images`, a setup (or its file) that describes the grid.
    images: your own image files, one for each plane of calibration.planes_mm in that order.
    """
    files = [os.fspath(one) for one in images]
    if isinstance(given, (Setup, Mapping)) and not files:
        raise ValueError("a setup has no images; give images, one for each plane, or render it and give its case")
    with reporting(progress) as report, tempfile.TemporaryDirectory() as folder, hidden_folder(folder):
        return Calibration(_core.calibrate(place_of(folder, given), files, report))
