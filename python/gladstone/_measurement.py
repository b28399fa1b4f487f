"""Common parts of the measurements of density, displacement and camera: text, warnings, and temporary files for the
inputs."""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from collections.abc import Mapping, Sequence

import numpy as np

from ._calibration_case import CalibrationCase
from ._case import Case
from ._errors import WarningText
from ._field import Field
from ._setup import Setup, as_setup

Box = Sequence[float]
"""Corners x0, y0, x1, y1 of a box in mm from the optical axis, x to the right and y upwards."""


class InputFolder:
    """Temporary folder for the input files of a measurement; deleted when the last object that uses it is deleted."""

    def __init__(self):
        self.name = tempfile.mkdtemp(prefix="gladstone_")
        weakref.finalize(self, shutil.rmtree, self.name, ignore_errors=True)


class Measurement:
    """Base class of results that the compiled part of gladstone has computed."""

    def __init__(self, core, inputs: InputFolder | None = None):
        """inputs: folder with the files from which the measurement was computed; `save` checks and records their
        hashes."""
        self._core = core
        self._inputs = inputs

    @property
    def warnings(self) -> list[WarningText]:
        """Warnings about the measurement."""
        return self._core.warnings

    def __str__(self) -> str:
        return self._core.text()


def _reference_text(region: str | Box) -> str:
    return region if isinstance(region, str) else ",".join(repr(float(corner)) for corner in region)


def reference_texts(reference: str | Box | Sequence[str | Box] | None) -> list[str]:
    """Returns the regions in the notation of the option --reference."""
    if reference is None:
        return []
    single = isinstance(reference, str) or np.ndim(reference[0]) == 0 and not isinstance(reference[0], str)
    return [_reference_text(region) for region in ([reference] if single else reference)]


def case_place(folder: str, case: Case | CalibrationCase, name: str = "case") -> str:
    """Returns the CASE folder of a case; one in memory is written into `folder`."""
    if isinstance(case, Case) and case._core.folder:
        return case._core.folder
    place = os.path.join(folder, name)
    case.save(place)
    return place


def measured_case_place(folder: str, case: Case, name: str, device: str) -> str:
    """Returns the CASE folder of a case with its vectors; a case in memory is correlated and written into `folder`."""
    place = case_place(folder, case, name)
    if not case._core.folder:
        case.correlate(device=device).save(os.path.join(place, "vectors.h5"))
    return place


def place_of(
    folder: str, setup: Setup | Mapping | Case | CalibrationCase | str | os.PathLike, name: str = "setup"
) -> str:
    """Returns the CASE folder or the setup file of a case or a setup; data in memory are written into `folder`."""
    if isinstance(setup, (Case, CalibrationCase)):
        return case_place(folder, setup, name)
    if isinstance(setup, (Setup, Mapping)):
        place = os.path.join(folder, name + ".toml")
        as_setup(setup).save(place)
        return place
    return os.fspath(setup)


def vectors_place(folder: str, source, name: str = "vectors") -> str:
    """Returns the file of vectors; those in memory are written into `folder`."""
    if isinstance(source, (str, os.PathLike)):
        return os.fspath(source)
    vectors = os.path.join(folder, name + ".h5")
    Field.of(source).save(vectors)
    return vectors
