"""Parameter studies."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from . import _core, _toml
from ._errors import hidden_folder
from ._progress import Progress, reporting
from ._setup import as_setup


class Study:
    """Parameter study over any keys of a setup. The cases are computed one by one and stored in a folder; an
    interrupted study can be continued."""

    def __init__(
        self,
        base,
        axes: Mapping[str, Sequence[Any] | Mapping[str, Any]],
        *,
        repeats: int = 1,
        seed: int = 1,
        mode: Literal["grid", "zip", "sobol"] = "grid",
        samples: int | None = None,
    ):
        """Describes a study.

        base: setup of all cases: a `Setup`, a dictionary of tables, or a setup file.
        axes: values by key path: `{"lens.f_number": [4, 8, 16], "geometry.z_d_mm": {"linear": [100, 1000, 10]}}`.
        repeats: number of cases per point, which differ in the random dots, rays and noise.
        seed: random seed of the first repeat, from which the seeds of further repeats are derived.
        mode: "grid" (all combinations), "zip" (the first values of all axes, then the second ones, ...) or "sobol"
            (quasi-random samples of the ranges).
        samples: number of samples with "sobol".
        """
        self._path: str | None = None
        self._axes = list(axes)
        self._base = as_setup(base)
        settings: dict[str, Any] = {"mode": mode, "repeats": repeats, "seed": seed}
        if samples is not None:
            settings["samples"] = samples
        lines = ['base = "base.toml"', "", "[axes]"]
        lines += [f"{_toml.key(path)} = {_toml.value(values)}" for path, values in axes.items()]
        lines += ["", "[study]", *(f"{name} = {_toml.value(value)}" for name, value in settings.items())]
        self._text = "\n".join(lines) + "\n"

    @classmethod
    def from_file(cls, path: str | os.PathLike) -> Study:
        """Reads a study file (TOML)."""
        study = cls.__new__(cls)
        study._path = os.fspath(path)
        return study

    def __repr__(self) -> str:
        return f"<gladstone.Study {self._path or 'of ' + ', '.join(self._axes)}>"

    def plan(self, folder: str | os.PathLike, *, device: str = "auto", progress: Progress = False) -> StudyRun:
        """Checks all cases and writes the plan into a folder, unless the folder already contains an equal plan."""
        place = os.fspath(folder)
        with reporting(progress) as report:
            if self._path is not None:
                _core.study_plan(self._path, place, device, report)
            else:
                with tempfile.TemporaryDirectory() as temporary, hidden_folder(temporary):
                    self._base.save(os.path.join(temporary, "base.toml"))
                    path = os.path.join(temporary, "study.toml")
                    with open(path, "w", encoding="utf-8") as file:
                        file.write(self._text)
                    _core.study_plan(path, place, device, report)
        return StudyRun(place)

    def run(
        self,
        folder: str | os.PathLike,
        *,
        device: str = "auto",
        keep_images: bool = False,
        pairs_only: bool = False,
        retry_failed: bool = False,
        progress: Progress = False,
    ) -> StudyRun:
        """Plans the study and computes the missing cases. Returns the results; for the options see
        `StudyRun.compute`."""
        run = self.plan(folder, device=device)
        run.compute(
            keep_images=keep_images, pairs_only=pairs_only, retry_failed=retry_failed, progress=progress
        )
        return run


class StudyRun:
    """Folder of a study with its results."""

    def __init__(self, folder: str | os.PathLike):
        self.folder = os.fspath(folder)

    def compute(
        self,
        *,
        keep_images: bool = False,
        pairs_only: bool = False,
        retry_failed: bool = False,
        cases: str | None = None,
        progress: Progress = False,
    ) -> None:
        """Computes the missing cases, as `gladstone sweep run`.

        keep_images: also write the images and all other files of each case.
        pairs_only: compute and keep only the images, without correlation and errors.
        retry_failed: compute failed cases again.
        cases: only these cases, by index: "17", or "0-3,7"; default: all.
        """
        with reporting(progress) as report:
            _core.study_run(self.folder, keep_images, pairs_only, retry_failed, cases, report)

    @property
    def state(self) -> dict[str, Any]:
        """Numbers of all, done, failed, missing and running cases, and the failed cases with their errors."""
        return json.loads(_core.study_state(self.folder))

    @property
    def table(self) -> dict[str, np.ndarray]:
        """Returns the columns of study.csv by name, with one value for each case. Also writes study.csv and study.h5.

        The name of an axis is its key path; the name of a measure is that in errors.json, such as "ray_truth.rms_px".
        """
        columns = {}
        for name, (values, labels, _) in _core.study_collect(self.folder).items():
            columns[name] = np.array(labels)[values.astype(int)] if labels else values
        return columns

    def to_pandas(self):
        """Returns the table as a pandas.DataFrame, a row for each case."""
        import pandas

        return pandas.DataFrame(self.table)

    @property
    def ranking(self) -> list[dict[str, Any]]:
        """Returns, for each measure of the error, the points of the study in ascending order: `measure`, `meaning`, and
        `points` with the index of the first `case` and the mean `value` over the repeats."""
        return json.loads(_core.study_ranking(self.folder))

    def draw(self, folder: str | os.PathLike | None = None, formats: Sequence[str] = ("png", "svg")) -> list[str]:
        """Draws the figures of `gladstone sweep collect` by gnuplot; default: into RUN/figures. Returns their paths."""
        place = os.path.join(self.folder, "figures") if folder is None else os.fspath(folder)
        return _core.study_draw(self.folder, place, list(formats))

    def pack(self, path: str | os.PathLike, *, device: str = "auto", progress: Progress = False) -> int:
        """Packs images and true displacements of all cases into one HDF5 file for training and tests.

        Requires cases computed with keep_images. Returns their number.
        """
        with reporting(progress) as report:
            return _core.study_dataset(self.folder, os.fspath(path), device, report)

    def __repr__(self) -> str:
        state = self.state
        return f"<gladstone.StudyRun {self.folder}: {state['done']} of {state['cases']} cases>"
