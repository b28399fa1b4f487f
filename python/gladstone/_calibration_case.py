"""Rendered images of a calibration."""

from __future__ import annotations

import os

import numpy as np

from . import _core
from ._setup import Setup


class CalibrationCase:
    """Images of a dot grid in several planes, taken by one camera."""

    def __init__(self, core: _core.PlanesCase):
        self._core = core

    @property
    def images(self) -> np.ndarray:
        """[planes, rows, columns] grey levels, uint16."""
        return self._core.images()

    @property
    def planes_m(self) -> np.ndarray:
        """[planes] Z of each plane [m]."""
        return np.asarray(self._core.planes_m)

    @property
    def setup(self) -> Setup:
        """Setup with all keys: defaults are included, and every "auto" is replaced by the value that was used."""
        return Setup(self._core.resolved())

    def save(self, folder: str | os.PathLike) -> None:
        """Writes the CASE folder: plane_000.tif, ..., truth.h5, setup.toml, summary.json."""
        self._core.save(os.fspath(folder))

    def __repr__(self) -> str:
        planes, rows, columns = self.images.shape
        return f"<gladstone.CalibrationCase {planes} planes, {columns} x {rows} px>"
