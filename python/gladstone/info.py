"""Descriptions of files and setups, as `gladstone info` prints them."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import Any

import numpy as np

from . import _core
from ._errors import check_whole
from ._images import image_array
from ._setup import as_setup


def lens(
    file: str | os.PathLike,
    *,
    glasses: Iterable[str | os.PathLike] = (),
    wavelength_nm: float = 0.0,
    figure: str | os.PathLike | None = None,
) -> dict[str, Any]:
    """Describes a lens prescription (.toml, .zmx, .seq): cardinal points, pupils, spot sizes, distortion.

    glasses: glass catalogues (.agf) in addition to the built-in ones.
    wavelength_nm: wavelength [nm]; default: the primary wavelength of the file.
    figure: path of a figure (.png, .svg) to draw.
    """
    catalogues = [os.fspath(one) for one in glasses]
    return json.loads(_core.info_lens(os.fspath(file), catalogues, wavelength_nm, os.fspath(figure or "")))


def field(
    file: str | os.PathLike,
    *,
    dataset: str = "",
    axes: str = "",
    setup: str | os.PathLike | None = None,
    figure: str | os.PathLike | None = None,
) -> dict[str, Any]:
    """Describes a density or refractive-index field: nodes, spacing, extent [mm], extremes, steepest gradient.

    dataset: name of the dataset within the file.
    axes: world axes in the order of the file's dimensions, slowest first, such as "zyx".
    setup: setup file; also reports how much of its field of view the field covers.
    figure: path of a drawing of the three planes through its middle (.png, .svg, .pdf).
    """
    return json.loads(
        _core.info_field(os.fspath(file), dataset, axes, os.fspath(setup or ""), os.fspath(figure or ""))
    )


def image(given, *, bit_depth: int = 0) -> dict[str, Any]:
    """Describes an image file or an array [rows, columns]: grey levels, dot diameter [px], noise, SNR."""
    if isinstance(given, (str, os.PathLike)):
        return json.loads(_core.info_image_file(os.fspath(given)))
    check_whole("bit_depth", bit_depth, 0, 64)
    return json.loads(_core.info_image(image_array(given, "image"), bit_depth))


def particles(setup) -> dict[str, Any]:
    """Describes the expected particles of a PIV setup: image diameter [px], photons, particles per window."""
    return json.loads(_core.info_particles(as_setup(setup)._core))


def setup(given, *, figure: str | os.PathLike | None = None) -> dict[str, Any]:
    """Describes a setup before it is rendered: magnification, view, blur, dots in view, time and memory.

    figure: path of a drawing of the layout (.png, .svg, .pdf).
    """
    return json.loads(_core.info_setup(as_setup(given)._core, os.fspath(figure or "")))


class Mie:
    """Light scattered by a homogeneous sphere in a plane wave; see `mie`."""

    def __init__(self, x: float, m: complex, numbers: dict[str, Any]):
        self.x, self.m = x, m
        self.q_ext: float = numbers["q_ext"]
        self.q_sca: float = numbers["q_sca"]
        self.q_back: float = numbers["q_back"]
        self.g: float = numbers["g"]
        angle, s11 = np.array(numbers["s11"]).T
        self.angle_deg: np.ndarray = angle
        self.s11: np.ndarray = s11
        self.polarization: np.ndarray = np.array(numbers["polarization"])[:, 1]

    def amplitudes(self, angle_deg) -> tuple[np.ndarray, np.ndarray]:
        """Returns S1 and S2, the complex amplitudes for an electric field perpendicular and parallel to the scattering
        plane.

        angle_deg: scattering angles [deg]; 0 is forward.
        """
        angles = np.atleast_1d(np.asarray(angle_deg, float))
        radians = np.ascontiguousarray(np.deg2rad(angles).ravel())
        both = _core.mie_amplitudes(self.x, self.m.real, self.m.imag, radians)
        return both[:, 0].reshape(angles.shape), both[:, 1].reshape(angles.shape)

    def __repr__(self) -> str:
        return f"<gladstone.Mie x={self.x:g}, m={self.m:g}, q_ext={self.q_ext:.6g}, q_sca={self.q_sca:.6g}>"


def mie(x: float, m: complex, *, figure: str | os.PathLike | None = None) -> Mie:
    """Computes the light scattered by a sphere (Bohren & Huffman 1983).

    x: size parameter pi d n / lambda.
    m: refractive index of the sphere relative to that of its surroundings, n + i k.
    figure: path of a polar plot (.png, .svg) to draw.

    Returns an object with q_ext, q_sca, q_back, g, and s11 and polarization over angle_deg.
    """
    x, m = float(x), complex(m)
    text = _core.info_mie(x, m.real, m.imag, os.fspath(figure or ""))
    return Mie(x, m, json.loads(text))
