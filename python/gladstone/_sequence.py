"""Sequences of image pairs."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Iterator
from typing import Any, Literal

import numpy as np

from . import _core
from ._correlate import image_files, overrides
from ._errors import DataError, WarningText
from ._field import Field
from ._progress import Progress, reporting


class Sequence:
    """Displacement fields of a sequence and their statistics, read from the folder to which they were written.

    `len(sequence)` is the number of pairs; `sequence[k]` reads the field of pair k, and iteration yields the fields of
    the pairs that were measured, one at a time.
    """

    def __init__(self, folder: str, result: dict[str, Any], temporary=None):
        self._folder, self._result, self._temporary = folder, result, temporary
        for pair in result["pairs"]:
            pair["warnings"] = [WarningText(**record) for record in pair.pop("warning_records")]

    @property
    def folder(self) -> str:
        """Folder with the vectors of each pair, statistics.h5 and sequence.json."""
        return self._folder

    @property
    def pairs(self) -> list[dict[str, Any]]:
        """For each pair: images `a` and `b`, file of its `vectors` (None: not correlated), `error` (reason, if the pair
        has no valid vector), `warnings`, `resumed`.
        """
        return self._result["pairs"]

    @property
    def failed(self) -> list[int]:
        """Indices of the pairs without valid vectors; `pairs[k]["error"]` is the reason."""
        return [k for k, pair in enumerate(self.pairs) if pair["error"]]

    @property
    def statistics(self) -> dict[str, np.ndarray]:
        """Statistics over the pairs as arrays [rows, columns] of statistics.h5: x_px, y_px, count, u_mean_px, u_rms_px,
        uu_px2, ... (NaN: unknown)."""
        return _core.sequence_statistics(os.path.join(self._folder, "statistics.h5"))

    def dots(self, index: int) -> dict[str, np.ndarray]:
        """Reads the scattered vectors of the dots or particles of a pair, for method="tracking".

        Arrays with one value per dot of frame A: x_px, y_px, u_px, v_px, sigma_u_px, sigma_v_px, status (0: valid), and
        unless pairing="pairs" `track`, the number of its track: consecutive images have one number per particle, and
        images with a common reference one number per dot. Raises ValueError if the pair failed or was not tracked.
        """
        pair = self.pairs[index]
        path = os.path.join(self._folder, "dots", pair["vectors"] or "")
        if pair["vectors"] is None or not os.path.exists(path):
            raise ValueError(f"pair {index} has no dots ({pair['error'] or 'its method is not tracking'})")
        return _core.sequence_statistics(path)

    def plot(self):
        """Draws maps of the mean and of the standard deviation of both components; needs matplotlib."""
        from ._plot import plot_statistics

        return plot_statistics(self.statistics)

    @property
    def device(self) -> str:
        """Device of the correlation: "cpu" or "cuda"."""
        return self._result["device"]

    @property
    def seconds(self) -> float:
        """Wall time of the correlation [s]."""
        return self._result["seconds"]

    def __len__(self) -> int:
        return len(self.pairs)

    def __getitem__(self, index: int) -> Field:
        """Reads the field of a pair. Raises ValueError if the pair could not be correlated."""
        pair = self.pairs[index]
        if pair["vectors"] is None:
            raise ValueError(f"pair {index} has no vectors ({pair['error']})")
        return Field.load(os.path.join(self._folder, pair["vectors"]))

    def __iter__(self) -> Iterator[Field]:
        return (self[k] for k, pair in enumerate(self.pairs) if not pair["error"])

    def __repr__(self) -> str:
        return f"<gladstone.Sequence {len(self)} pairs, {len(self) - len(self.failed)} measured>"


def correlate_sequence(
    images: str | os.PathLike | Iterable[str | os.PathLike],
    *,
    pairing: Literal["pairs", "reference", "consecutive"] = "pairs",
    output: str | os.PathLike | None = None,
    config: str | os.PathLike | None = None,
    device: str = "auto",
    progress: Progress = False,
    **settings,
) -> Sequence:
    """Measures the displacement of every pair of a sequence of image files, and the statistics over the pairs.

    images: a folder, a pattern such as "frames/*.tif", two patterns such as ["A_*.tif", "B_*.tif"], or a list of files.
    pairing: "pairs" (frame A and frame B of each instant), "reference" (the first image with each other one, for BOS)
        or "consecutive" (each image with the next one; method="tracking" then follows particles over four frames).
    output: folder for the vectors and statistics. The same call continues an interrupted run in it. Default: a
        temporary folder, which exists as long as the returned object.
    config: TOML file with a table [correlate]; default: all settings have their defaults.
    settings: window, overlap, method, ..., as for `correlate`.

    The files are equal to those of `gladstone correlate IMAGES -o OUTPUT/`. A pair that fails does not affect the
    others: a `GladstoneWarning` names it, and `failed` lists it. Raises `DataError` if no pair has a valid vector, and
    `SetupError` for settings.
    """
    files = image_files([images] if isinstance(images, (str, os.PathLike)) else images)
    if not files:
        raise DataError("images", "no image is given; give a pattern, a folder, or a list of files", "arguments")
    temporary = tempfile.TemporaryDirectory(prefix="gladstone_") if output is None else None
    folder = os.path.join(temporary.name, "vectors") if temporary else os.fspath(output)
    with reporting(progress) as report:
        text = _core.correlate_sequence(
            files,
            pairing,
            folder,
            "" if config is None else os.fspath(config),
            overrides(settings),
            device,
            report,
        )
    return Sequence(folder, json.loads(text), temporary)
