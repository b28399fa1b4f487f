"""Previews of a setup before it is rendered: a part of its images, and its dot pattern."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from . import _core
from ._progress import Progress, reporting
from ._setup import Setup, as_setup


class Preview:
    """Rendered part of the images of a camera; see `preview`."""

    def __init__(self, images: np.ndarray, first_px: tuple[int, int], at_gradient: bool, sources: int):
        self.images: np.ndarray = images
        """[frames, rows, columns] grey levels, uint16: frames a and b, or the plane closest to Z = 0 of a
        calibration."""
        self.first_px: tuple[int, int] = first_px
        """Column and row of the part's first pixel in the complete images [px]."""
        self.at_gradient: bool = at_gradient
        """True: the part is centred on the strongest density gradient in view; False: on the image centre."""
        self.sources: int = sources
        """Number of dots or particles that were traced."""

    def __repr__(self) -> str:
        frames, rows, columns = self.images.shape
        column, row = self.first_px
        return f"<gladstone.Preview {frames} frames, {columns} x {rows} px from column {column} and row {row}>"


def preview(
    setup: Setup | Mapping[str, Any] | str | os.PathLike, *, device: str = "auto", progress: Progress = False
) -> Any:
    """Renders 128 x 128 px about the strongest density gradient, or about the image centre, within seconds.

    The pixels equal those of the complete images to within the scatter of the rays, except that `camera.exposure =
    "auto"` is determined from this part only.

    setup: a `Setup`, a dictionary of tables, or a setup file.

    Returns a `Preview`; for a setup with several cameras, a dictionary of previews by name of the camera.
    """
    with reporting(progress) as report:
        rendered = _core.previews(as_setup(setup)._core, device, report)
    previews = {
        camera: Preview(images, (column, row), at_gradient, sources)
        for camera, images, column, row, at_gradient, sources in rendered
    }
    return previews.get("", previews)  # the name of a single camera is empty


def target(setup: Setup | Mapping[str, Any] | str | os.PathLike, path: str | os.PathLike) -> dict[str, Any]:
    """Writes the dot pattern of the renderer at true scale, as `gladstone target` does.

    setup: setup of a BOS experiment or a calibration: a `Setup`, a dictionary of tables, or a setup file.
    path: .pdf or .svg with a scale bar, for printing, or .csv (x_mm,y_mm).

    Returns the number of `dots`, `dot_diameter_mm`, `extent_mm`, `page_mm` and `scale_bar_mm`.
    """
    return json.loads(_core.target(as_setup(setup)._core, os.fspath(path)))
