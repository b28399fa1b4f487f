"""Displacement fields: measurement, files and exchange."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable
from typing import Any

import numpy as np

from . import _core, _toml
from ._messages import deliver
from ._progress import Progress, reporting


def _host_image(image):
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


def _check_image(image, name: str) -> None:
    """Raises a TypeError, or ValueError, for what is no image [rows, columns]."""
    if image is None or isinstance(image, (str, os.PathLike)):
        raise TypeError(
            f"{name} is {image!r}, not an image [rows, columns]; read files first, for example by tifffile.imread"
        )
    shape = getattr(image, "shape", None)
    if shape is not None and len(shape) != 2:
        raise ValueError(f"{name} has the shape {tuple(shape)}; give a grey image [rows, columns]")


def _overrides(settings: dict[str, Any]) -> list[str]:
    """Returns settings of the correlation as assignments of setup keys, "correlate.overlap=0.5"."""
    given = {name: value for name, value in settings.items() if value is not None}
    if "window" in given:
        window = given.pop("window")
        given["window_px"] = [window] if np.ndim(window) == 0 else list(window)
    return [f"correlate.{name}={_toml.value(value)}" for name, value in given.items()]


def correlate(a, b, *, device: str = "auto", progress: Progress = False, **settings) -> Field:
    """Measures the displacement from frame a to frame b by cross-correlation.

    a, b: images [rows, columns] of any array library with the buffer or the DLPack protocol (NumPy, torch, CuPy, JAX),
        of integers or floats, in any memory layout. BOS: the reference image first. Each is copied once, to float64.
    window: size of the interrogation window in each pass [px], for example [64, 32, 24, 20].
    overlap: fraction of the window that neighbouring windows share.
    uncertainty: method that estimates sigma_u and sigma_v; default: correlation statistics on a CPU, none on a GPU.
    Further settings are the keys of the table [correlate]: method, subpixel, weighting, mask, ...

    The vectors are equal bit by bit to those of `gladstone correlate`.
    Raises `SetupError` for settings and `DataError` for images that cannot be correlated.
    """
    _check_image(a, "a")
    _check_image(b, "b")
    with reporting(progress) as report:
        core = _core.correlate(_host_image(a), _host_image(b), _overrides(settings), device, report)
    field = Field._of(core)
    warnings = field.warnings
    if not warnings and not field.valid.any():
        warnings = [
            f"none of the {len(field)} vectors is valid; "
            "check that both frames show one scene, with dots in every window"
        ]
    deliver([(True, warning) for warning in warnings])
    return field


def correlate_ensemble(
    images: Iterable[str | os.PathLike], *, progress: Progress = False, **settings
) -> Field:
    """Measures one displacement field from many pairs, by the mean of their correlation planes, on the CPU.

    images: image files, frames a and b of each pair in turn, all of one size.
    settings: window, overlap, method, ..., as for `correlate`.

    The vectors are equal bit by bit to those of `gladstone correlate --ensemble`.
    """
    files = [os.fspath(one) for one in images]
    if not files or len(files) % 2:
        raise ValueError(f"got {len(files)} images; give frames a and b of each pair")
    with reporting(progress) as report:
        field = Field._of(_core.correlate_ensemble(files, _overrides(settings), report))
    deliver([(True, warning) for warning in field.warnings])
    return field


class Field:
    """Displacement vectors. On a complete grid, arrays have the shape [rows, columns], else [N].

    Positions and displacements are in px: column x to the right, row y downwards, from 0 at the centre of the first
    pixel; displacements from frame a to frame b.
    """

    def __init__(self, x, y, u, v, sigma_u=None, sigma_v=None):
        """Makes a field of arrays of equal size: positions and displacements [px], standard uncertainties [px].

        A displacement of NaN marks an invalid vector.
        """
        arrays = (x, y, u, v, sigma_u, sigma_v)
        flat = [None if one is None else np.ascontiguousarray(one, float).ravel() for one in arrays]
        self._core = _core.field_of_arrays(*flat)

    @classmethod
    def _of(cls, core: _core.MeasuredField) -> Field:
        field = cls.__new__(cls)
        field._core = core
        return field

    @classmethod
    def of(cls, given) -> Field:
        """Returns a field: of a `Field`, of arrays (x, y, u, v), of an xarray data set, of dense displacements
        [rows, columns, 2] at every pixel, or of the path of a file for `load`."""
        if isinstance(given, Field):
            return given
        if given is None:
            raise TypeError("expected vectors, got None; does the function that measured them return them?")
        if isinstance(given, (str, os.PathLike)):
            return cls.load(given)
        if hasattr(given, "data_vars"):
            return cls.from_xarray(given)
        if isinstance(given, (tuple, list)):
            return cls(*given)
        return cls.from_dense(given)

    @classmethod
    def from_dense(cls, displacement, spacing_px: int = 1) -> Field:
        """Makes a field of displacements [rows, columns, 2] or [2, rows, columns] at the pixels of an image [px]."""
        dense = np.asarray(_host_image(displacement), float)
        if dense.ndim == 3 and dense.shape[-1] != 2 and dense.shape[0] == 2:
            dense = np.moveaxis(dense, 0, -1)
        if dense.ndim != 3 or dense.shape[-1] != 2:
            raise ValueError(f"expected displacements [rows, columns, 2], got an array of shape {dense.shape}")
        rows, columns = dense.shape[:2]
        y, x = np.mgrid[0:rows, 0:columns] * float(spacing_px)
        return cls(x, y, dense[..., 0], dense[..., 1])

    @classmethod
    def load(cls, path: str | os.PathLike, *, conventions: str = "", image_rows: int = 0) -> Field:
        """Reads a file of vectors: gladstone, OpenPIV, PIVlab, DaVis, Insight, Dantec, JPIV or any x, y, u, v.

        conventions: conventions of the file, as for `gladstone compare --conventions`; default: those of its format.
        image_rows: number of rows of the image, required for files that count y upwards from its lower edge.
        """
        return cls._of(_core.load_field(os.fspath(path), conventions, image_rows))

    def save(self, path: str | os.PathLike) -> None:
        """Writes vectors in the format of the ending, as `gladstone convert` does: .h5, .csv, .nc, .mat, .dat, .vti, .vtp.

        .nc (NetCDF in pivpy's schema, as `to_xarray`) and .vti require vectors on a grid.
        """
        self._core.save(os.fspath(path))

    def _array(self, name: str, component: int | None = None) -> np.ndarray:
        array = self._core.array(name)
        if array is None:
            array = np.full((len(self), 2) if component is not None else len(self), np.nan)
        if component is not None:
            array = array[:, component]
        return array.reshape(self.shape)

    @property
    def shape(self) -> tuple[int, ...]:
        """(rows, columns) of the grid; (N,) for scattered vectors."""
        return (self._core.rows, self._core.columns) if self._core.columns > 0 else (self._core.size,)

    def __len__(self) -> int:
        return self._core.size

    @property
    def x(self) -> np.ndarray:
        """Column of the vectors [px]."""
        return self._array("position", 0)

    @property
    def y(self) -> np.ndarray:
        """Row of the vectors [px]."""
        return self._array("position", 1)

    @property
    def u(self) -> np.ndarray:
        """Displacement to the right [px]."""
        return self._array("displacement", 0)

    @property
    def v(self) -> np.ndarray:
        """Displacement downwards [px]."""
        return self._array("displacement", 1)

    @property
    def sigma_u(self) -> np.ndarray:
        """Standard uncertainty of u [px]; NaN: not estimated."""
        return self._array("sigma", 0)

    @property
    def sigma_v(self) -> np.ndarray:
        """Standard uncertainty of v [px]; NaN: not estimated."""
        return self._array("sigma", 1)

    @property
    def status(self) -> np.ndarray:
        """0 valid, 1 replaced, 2 masked, 3 invalid."""
        array = self._core.array("status")
        return (np.zeros(len(self), np.uint8) if array is None else array).reshape(self.shape)

    @property
    def valid(self) -> np.ndarray:
        """True for vectors that count in statistics (valid or replaced)."""
        return self.status <= 1

    @property
    def peak_ratio(self) -> np.ndarray:
        """Highest over second correlation peak; NaN: not measured."""
        return self._array("peak_ratio")

    @property
    def correlation(self) -> np.ndarray:
        """Correlation coefficient of the peak; NaN: not measured."""
        return self._array("correlation")

    @property
    def settings(self) -> dict[str, Any]:
        """Settings of the correlation with every default; empty for vectors of other programs."""
        return tomllib.loads(self._core.settings).get("correlate", {}) if self._core.settings else {}

    @property
    def verdict(self) -> str:
        """Result of the decorrelation test: "correlates", "does not correlate" or "not judged: REASON"."""
        return self._core.verdict

    @property
    def uncertainty_method(self) -> str:
        """Method that estimated sigma_u and sigma_v: a value of correlate.uncertainty, or "dot_fit" of tracked dots;
        "none": not estimated, "": unknown."""
        return self._core.uncertainty_method

    @property
    def uncertainty_key(self) -> str:
        """Key that selected this method, for example 'correlate.uncertainty = "auto"'; "": unknown."""
        return self._core.uncertainty_key

    @property
    def warnings(self) -> list[str]:
        """Warnings about the measurement."""
        return list(self._core.warnings)

    @property
    def device(self) -> str:
        """Device of the correlation: "cpu" or "cuda"."""
        return self._core.device

    @property
    def seconds(self) -> float:
        """Wall time of the correlation [s]."""
        return self._core.seconds

    def to_xarray(self, frame: int = 0):
        """Returns an xarray.Dataset in pivpy's schema: u, v and chc over (y, x, t), in px.

        Further variables: sigma_u, sigma_v, peak_ratio, status. chc is 1 for vectors that count, else 0.
        """
        import xarray

        if len(self.shape) != 2:
            raise ValueError("scattered vectors have no grid, which this schema needs")

        def variable(values, units: str, long_name: str, standard_name: str | None = None):
            attributes = {"units": units, "long_name": long_name}
            if standard_name:
                attributes["standard_name"] = standard_name
            return ("y", "x", "t"), np.asarray(values, float)[:, :, np.newaxis], attributes

        return xarray.Dataset(
            {
                "u": variable(self.u, "pix", "displacement to the right", "u_velocity"),
                "v": variable(self.v, "pix", "displacement downwards", "v_velocity"),
                "chc": variable(self.valid, "1", "1: valid or replaced, 0: masked or invalid", "validity_flag"),
                "sigma_u": variable(self.sigma_u, "pix", "standard uncertainty of u"),
                "sigma_v": variable(self.sigma_v, "pix", "standard uncertainty of v"),
                "peak_ratio": variable(self.peak_ratio, "1", "highest over second correlation peak"),
                "status": variable(self.status, "1", "0 valid, 1 replaced, 2 masked, 3 invalid"),
            },
            coords={
                "x": ("x", self.x[0, :].copy(), {"units": "pix"}),
                "y": ("y", self.y[:, 0].copy(), {"units": "pix"}),
                "t": ("t", [float(frame)], {"units": "frame"}),
            },
            attrs={
                "delta_t": 1.0,
                "files": [self._core.name],
                "pivpy_schema_version": "1",
                "software": _core.version().split("\n")[0],
            },
        )

    @classmethod
    def from_xarray(cls, data) -> Field:
        """Makes a field of an xarray.Dataset in pivpy's schema; the first frame of several."""
        if "t" in data.dims:
            data = data.isel(t=0)
        u, v = (data[name].transpose("y", "x").values.astype(float) for name in ("u", "v"))
        if "chc" in data:
            rejected = data["chc"].transpose("y", "x").values <= 0
            u, v = np.where(rejected, np.nan, u), np.where(rejected, np.nan, v)
        x, y = np.meshgrid(data["x"].values, data["y"].values)
        return cls(x, y, u, v)

    def plot(self):
        """Draws maps of u and v. Returns a matplotlib figure."""
        from ._plot import plot_field

        return plot_field(self)

    def __repr__(self) -> str:
        size = " x ".join(str(one) for one in reversed(self.shape))
        return f"<gladstone.Field {size} vectors, {int(np.sum(self.valid))} valid or replaced>"
