"""Measurement of displacement fields."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

import numpy as np

from . import _core, _toml
from ._errors import WarningText
from ._field import Field
from ._images import gpu_image, image_array, mask_images, on_first_gpu
from ._messages import deliver
from ._progress import Progress, reporting


def overrides(settings: dict[str, Any]) -> list[str]:
    """Returns settings of the correlation as assignments of setup keys, "correlate.overlap=0.5"."""
    given = {name: value for name, value in settings.items() if value is not None}
    if "window" in given:
        window = given.pop("window")
        given["window_px"] = [window] if np.ndim(window) == 0 else list(window)
    return [f"correlate.{name}={_toml.value(value)}" for name, value in given.items()]


def image_files(images: Iterable[str | os.PathLike]) -> list[str]:
    """Returns the names of image files. Raises TypeError for arrays."""
    given = list(images)
    for one in given:
        if not isinstance(one, (str, os.PathLike)):
            raise TypeError(f"images must be names of image files, got {type(one).__name__}; write arrays to files first")
    return [os.fspath(one) for one in given]


def correlate(a, b, *, device: str = "auto", progress: Progress = False, **settings) -> Field:
    """Measures the displacement from frame a to frame b by cross-correlation.

    a, b: images [rows, columns] of any array library (NumPy, xarray, torch, CuPy, JAX, ...), of integers or of 32- or
        64-bit floats, in any memory layout. BOS: the reference image first. Each image is copied once, to float64,
        within the same memory: images on a GPU remain on the GPU. Pixels that are NaN, or masked by numpy.ma, are
        excluded from the windows.
    window: size of the interrogation window in each pass [px], for example [64, 32, 24, 20].
    overlap: fraction of the window that neighbouring windows share.
    uncertainty: method that estimates sigma_u and sigma_v; default: correlation statistics on a CPU, none on a GPU.
    mask: array of bool [rows, columns] that is True at the pixels to exclude, as in numpy.ma; or tables
        [correlate.mask]. Further settings are the keys of the table [correlate]: method, subpixel, weighting, ...

    The vectors are equal bit by bit to those of `gladstone correlate`.
    Raises `SetupError` for settings and `DataError` for images that cannot be correlated.
    """
    masked = getattr(settings.get("mask"), "dtype", None) == bool
    if not masked and device != "cpu" and on_first_gpu(a) and on_first_gpu(b) and _core.gpu_is_usable():
        a, b, measure = gpu_image(a, "a"), gpu_image(b, "b"), _core.correlate_gpu_images
    else:
        a, b, measure = image_array(a, "a"), image_array(b, "b"), _core.correlate
    if masked:
        a, b = mask_images(settings.pop("mask"), a, b)
    with reporting(progress) as report:
        field = Field._of(measure(a, b, overrides(settings), device, report))
    warnings = field.warnings
    if not warnings and not field.valid.any():
        warnings = [
            WarningText(
                "unreliable",
                "",
                f"none of the {len(field)} vectors is valid; "
                "check that both frames show one scene, with dots in every window",
            )
        ]
    deliver(warnings)
    return field


def correlate_ensemble(
    images: Iterable[str | os.PathLike], *, progress: Progress = False, **settings
) -> Field:
    """Measures one displacement field from many pairs, by the mean of their correlation planes, on the CPU.

    images: image files of equal size, in the order: frame a and frame b of the first pair, frame a and frame b of the
        second pair, ...
    settings: window, overlap, method, ..., as for `correlate`; `mask` must be tables.

    The vectors are equal bit by bit to those of `gladstone correlate --ensemble`.
    """
    files = image_files(images)
    if not files or len(files) % 2:
        raise ValueError(f"got {len(files)} images; give frames a and b of each pair")
    with reporting(progress) as report:
        field = Field._of(_core.correlate_ensemble(files, overrides(settings), report))
    deliver(field.warnings)
    return field
