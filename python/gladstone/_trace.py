"""Tracing of single rays."""

from __future__ import annotations

from typing import Literal

import numpy as np

from . import _core
from ._errors import check_choice
from ._setup import as_setup


class TracedRays:
    """Ends of traced rays; undefined numbers are NaN."""

    def __init__(self, status: list[str], numbers: np.ndarray):
        self.status: np.ndarray = np.array(status)
        """[N] status of each ray: "alive", "vignetted", "missed_sensor", "total_internal_reflection", ..."""
        self.position_mm: np.ndarray = numbers[:, 0:3]
        """[N, 3] end point in world coordinates [mm]."""
        self.direction: np.ndarray = numbers[:, 3:6]
        """[N, 3] direction at the end point, a unit vector."""
        self.optical_path_mm: np.ndarray = numbers[:, 6]
        """[N] length of the optical path from the start [mm]."""
        self.pixel: np.ndarray = numbers[:, 7:9]
        """[N, 2] column and row at which the ray meets the sensor [px]."""

    def __len__(self) -> int:
        return len(self.status)

    def __repr__(self) -> str:
        return f"<gladstone.TracedRays {int(np.sum(self.status == 'alive'))} of {len(self)} alive>"


def trace(setup, start_mm, direction, *, through: Literal["medium", "optics", "all"] = "all") -> TracedRays:
    """Traces rays through the medium and the lens of a setup, on the CPU.

    setup: a `Setup`, a dictionary of tables, or a setup file.
    start_mm: [N, 3] start points in world coordinates [mm]: X to the right, Y upwards, Z towards the camera.
    direction: [N, 3] directions of any length.
    through: position at which the rays end: behind the "medium", behind the "optics", or at the sensor ("all").
    """
    check_choice("through", through, ("medium", "optics", "all"))
    start = np.asarray(start_mm, float).reshape(-1, 3)
    rows = np.concatenate(np.broadcast_arrays(start, np.asarray(direction, float).reshape(-1, 3)), axis=1)
    status, numbers = _core.trace(as_setup(setup)._core, np.ascontiguousarray(rows).ravel(), through)
    return TracedRays(status, numbers)
