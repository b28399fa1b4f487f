"""Images of any array library."""

from __future__ import annotations

import os

import numpy as np


def host_image(image):
    """Returns an image in host memory: arrays of a GPU are copied, others are not."""
    if getattr(image, "requires_grad", False):
        image = image.detach()
    device = getattr(image, "__dlpack_device__", None)
    if device is not None and int(device()[0]) not in (1, 3):  # kDLCPU, kDLCUDAHost
        for method in ("get", "cpu"):  # CuPy, torch
            if hasattr(image, method):
                return getattr(image, method)()
        return np.asarray(image)  # JAX
    if isinstance(image, (list, tuple)):
        image = np.asarray(image)
    return image


def check_image(image, name: str) -> None:
    """Raises TypeError or ValueError unless `image` is an array [rows, columns]."""
    if image is None or isinstance(image, (str, os.PathLike)):
        raise TypeError(
            f"{name} is {image!r}, not an image [rows, columns]; read files first, for example by tifffile.imread"
        )
    shape = getattr(image, "shape", None)
    if shape is not None and len(shape) != 2:
        raise ValueError(f"{name} has the shape {tuple(shape)}; give a grey image [rows, columns]")
