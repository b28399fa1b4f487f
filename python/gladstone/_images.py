"""Images and numbers of any array library."""

from __future__ import annotations

import os

import numpy as np

from ._errors import DataError


def filled(values) -> np.ndarray:
    """Returns numbers as float64, with NaN in place of masked values."""
    return np.ma.filled(np.ma.asarray(values, float), np.nan)


kind_of_gpu = 2  # kDLCUDA


def on_first_gpu(image) -> bool:
    """Returns whether an image is in the memory of the GPU that gladstone uses."""
    device = getattr(image, "__dlpack_device__", None)
    return device is not None and tuple(int(value) for value in device()) == (kind_of_gpu, 0)


def gpu_image(image, name: str):
    """Returns an image [rows, columns] of the first GPU as a DLPack capsule, without a copy. Work on the default stream
    waits for the work that produces the image."""
    check_shape(image, name)
    return plain(image).__dlpack__(stream=1)  # the default stream


def plain(image):
    """Returns a torch tensor without its gradient; other images are returned unchanged."""
    return image.detach() if getattr(image, "requires_grad", False) else image


def check_shape(image, name: str) -> None:
    shape = getattr(image, "shape", None)
    if shape is not None and len(shape) != 2:
        raise ValueError(f"{name} has the shape {tuple(shape)}; give a grey image [rows, columns]")


def host_image(image):
    """Returns an image in host memory and native byte order, with NaN in place of masked pixels.

    Arrays on a GPU are copied; other arrays are copied only if they are masked or have a different byte order.
    """
    image = plain(image)
    device = getattr(image, "__dlpack_device__", None)
    if device is not None and int(device()[0]) not in (1, 3):  # kDLCPU, kDLCUDAHost
        for method in ("get", "cpu"):  # CuPy, torch
            if hasattr(image, method):
                return getattr(image, method)()
        return np.asarray(image)  # JAX
    if np.ma.is_masked(image):
        return filled(image)
    if device is None or isinstance(image, np.ndarray):
        image = np.asarray(image)
        image = image.astype(image.dtype.newbyteorder("="), copy=False)
    return image


def image_array(image, name: str):
    """Returns an image [rows, columns] in host memory, as `host_image` does. Raises TypeError, ValueError or DataError
    if the argument is not an image."""
    if image is None or isinstance(image, (str, os.PathLike)):
        raise TypeError(
            f"{name} is {image!r}, not an image [rows, columns]; read files first, for example by tifffile.imread"
        )
    array = host_image(image)
    if isinstance(array, np.ndarray) and not (array.dtype.kind in "biuf" and array.dtype.itemsize <= 8):
        raise DataError(
            name,
            f"is of type {type(image).__name__} with samples of {array.dtype}, not an image of integers or of 32- or "
            "64-bit floats; give an image of these, such as case.a, or convert it by image.astype(numpy.float32)",
            "wrong_type",
        )
    check_shape(array, name)
    return array


def mask_images(mask, *images) -> list[np.ndarray]:
    """Returns images of float64 whose pixels are NaN where `mask` [rows, columns] is True."""
    excluded = np.asarray(mask)
    for image in images:
        if excluded.shape != tuple(image.shape):
            raise ValueError(f"mask has the shape {excluded.shape}, but the images have {tuple(image.shape)}")
    return [np.where(excluded, np.nan, filled(image)) for image in images]
