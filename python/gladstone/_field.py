"""Displacement fields: reading, writing and conversion to other libraries."""

from __future__ import annotations

import os
import tempfile
import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np

from . import _core
from ._errors import WarningText, check_whole
from ._images import filled, host_image


class Field:
    """Displacement vectors. Arrays have the shape [rows, columns] if the vectors form a complete grid, else [N].

    Positions and displacements are in px: column x to the right, row y downwards, from 0 at the centre of the first
    pixel; displacements from frame a to frame b.
    """

    def __init__(self, x, y, u, v, sigma_u=None, sigma_v=None):
        """Creates a field from arrays of equal size: positions, displacements and standard uncertainties [px].

        A displacement that is NaN, or masked by numpy.ma, marks an invalid vector.
        """
        arrays = (x, y, u, v, sigma_u, sigma_v)
        flat = [None if one is None else np.ascontiguousarray(filled(one)).ravel() for one in arrays]
        self._core = _core.field_of_arrays(*flat)

    @classmethod
    def _of(cls, core: _core.MeasuredField) -> Field:
        field = cls.__new__(cls)
        field._core = core
        return field

    @classmethod
    def of(cls, given) -> Field:
        """Creates a field from any of the following: a `Field`, arrays (x, y, u, v), a table (pandas, or a dictionary)
        with columns x, y, u and v or x_px, y_px, u_px and v_px, an xarray data set, dense displacements [rows, columns,
        2] at every pixel, or the path of a file that `load` reads."""
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
        if isinstance(given, Mapping) or hasattr(given, "columns"):
            return cls._from_table(given)
        return cls.from_dense(given)

    @classmethod
    def _from_table(cls, table) -> Field:
        for ending in ("", "_px"):
            names = [name + ending for name in "xyuv"]
            if all(name in table for name in names):
                return cls(*(table[name] for name in names))
        raise ValueError(f"expected columns x, y, u and v, got {', '.join(map(str, table.keys()))}")

    @classmethod
    def from_dense(cls, displacement, spacing_px: int = 1) -> Field:
        """Creates a field from displacements [rows, columns, 2] or [2, rows, columns] at the pixels of an image [px].
        `spacing_px` is the distance between these pixels."""
        dense = np.asarray(host_image(displacement), float)
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

        conventions: conventions of the file, as for `gladstone compare --conventions`; default: the conventions of its
            format.
        image_rows: number of rows of the image, required for files that count y upwards from its lower edge.
        """
        check_whole("image_rows", image_rows, 0, 1_000_000)
        return cls._of(_core.load_field(os.fspath(path), conventions, image_rows))

    def save(self, path: str | os.PathLike) -> None:
        """Writes vectors in the format that the ending selects, as `gladstone convert` does: .h5, .csv, .nc, .mat,
        .dat, .vti, .vtp.

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
        """Validity of each vector: 0 valid, 1 replaced, 2 masked, 3 invalid."""
        array = self._core.array("status")
        return (np.zeros(len(self), np.uint8) if array is None else array).reshape(self.shape)

    @property
    def valid(self) -> np.ndarray:
        """True for vectors that are included in statistics (valid or replaced)."""
        return self.status <= 1

    @property
    def peak_ratio(self) -> np.ndarray:
        """Ratio of the highest to the second highest correlation peak; NaN: not measured."""
        return self._array("peak_ratio")

    @property
    def correlation(self) -> np.ndarray:
        """Correlation coefficient of the peak; NaN: not measured."""
        return self._array("correlation")

    @property
    def settings(self) -> dict[str, Any]:
        """Settings of the correlation, including all defaults; empty for vectors of other programs."""
        return tomllib.loads(self._core.settings).get("correlate", {}) if self._core.settings else {}

    @property
    def verdict(self) -> str:
        """Result of the decorrelation test: "correlates", "does not correlate" or "not judged: REASON"."""
        return self._core.verdict

    @property
    def verdict_code(self) -> str:
        """The verdict as a code: "correlates", "uncorrelated" or, if the pair is not judged, the reason:
        "identical_frames", "masked", "no_signal", "optical_flow", "few_windows", "no_median_test", "periodic" or
        "no_valid_vector"; "": not tested."""
        return self._core.verdict_code

    @property
    def verdict_number(self) -> float:
        """Number of the verdict: the required number of windows for "few_windows", the period of the pattern [px] for
        "periodic", otherwise 0."""
        return self._core.verdict_number

    @property
    def uncertainty_method(self) -> str:
        """Method that estimated sigma_u and sigma_v: a value of correlate.uncertainty, or "dot_fit" of tracked dots;
        "none": not estimated, "": unknown."""
        return self._core.uncertainty_method

    @property
    def uncertainty_key(self) -> str:
        """Key of the setup that selected the uncertainty method, for example 'correlate.uncertainty = "auto"'; "":
        unknown."""
        return self._core.uncertainty_key

    @property
    def warnings(self) -> list[WarningText]:
        """Warnings about the measurement."""
        return self._core.warnings

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

        Further variables: sigma_u, sigma_v, peak_ratio, status, u_raw, v_raw, correlation, reason, ambiguous. chc is 1
        for valid and replaced vectors, else 0.
        """
        import xarray

        if len(self.shape) != 2:
            raise ValueError("the vectors are scattered, but this schema requires a grid")

        def variable(values, units: str, long_name: str, standard_name: str | None = None):
            attributes = {"units": units, "long_name": long_name}
            if standard_name:
                attributes["standard_name"] = standard_name
            return ("y", "x", "t"), np.asarray(values, float)[:, :, np.newaxis], attributes

        def column(name: str):
            return self._core.column(name).reshape(self.shape)

        return xarray.Dataset(
            {
                "u": variable(self.u, "pix", "displacement to the right", "u_velocity"),
                "v": variable(self.v, "pix", "displacement downwards", "v_velocity"),
                "chc": variable(self.valid, "1", "1: valid or replaced, 0: masked or invalid", "validity_flag"),
                "sigma_u": variable(self.sigma_u, "pix", "standard uncertainty of u"),
                "sigma_v": variable(self.sigma_v, "pix", "standard uncertainty of v"),
                "peak_ratio": variable(self.peak_ratio, "1", "highest over second correlation peak"),
                "status": variable(self.status, "1", "0 valid, 1 replaced, 2 masked, 3 invalid"),
                "u_raw": variable(column("u_raw_px"), "pix", "displacement to the right before replacement"),
                "v_raw": variable(column("v_raw_px"), "pix", "displacement downwards before replacement"),
                "correlation": variable(
                    self.correlation, "1", "correlation coefficient of the peak at u_raw, v_raw"
                ),
                "reason": variable(column("reason"), "1", "origin of the vector: reason of vectors.h5"),
                "ambiguous": variable(
                    column("ambiguous"), "1", "1: another displacement has nearly the same correlation"
                ),
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

    def __getstate__(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "field.h5")
            self.save(path)
            with open(path, "rb") as file:
                return file.read(), self._core.name, self._core.seconds, self._core.foreign

    def __setstate__(self, state) -> None:
        contents, name, seconds, foreign = state
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "field.h5")
            with open(path, "wb") as file:
                file.write(contents)
            self._core = _core.load_field(path, "", 0)
        self._core.name, self._core.seconds, self._core.foreign = name, seconds, foreign

    def __repr__(self) -> str:
        size = " x ".join(str(one) for one in reversed(self.shape))
        return f"<gladstone.Field {size} vectors, {int(np.sum(self.valid))} valid or replaced>"
