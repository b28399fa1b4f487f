"""Commands that read and write files and folders: sequences, conversions, views, reports, examples, and comparisons
with exact solutions."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Mapping
from typing import Any, Literal, NamedTuple

from . import _core
from ._errors import check_choice, check_whole, hidden_folder
from ._progress import Progress, reporting
from ._report import check_report_ending
from ._setup import Setup, as_setup


def render_sequence(
    setup: Setup | Mapping[str, Any] | str | os.PathLike,
    folder: str | os.PathLike,
    *,
    device: str = "auto",
    progress: Progress = False,
) -> dict[str, Any]:
    """Renders a setup with a table [sequence] into a folder, as `gladstone render` does: the frames, and a CASE of each
    pair.

    setup: a `Setup`, a dictionary of tables, or a setup file.
    folder: the frames are in `frames`, the cases in `pair_0000`, ...; `Case.load` reads them. The same call continues
        an interrupted run.

    Returns the contents of summary.json.
    """
    given = as_setup(setup)
    with tempfile.TemporaryDirectory() as temporary, hidden_folder(temporary), reporting(progress) as report:
        path, overrides = os.path.join(given._core.folder, os.path.basename(given._core.name)), given._core.overrides
        if not given._from_file:
            path, overrides = os.path.join(temporary, "setup.toml"), []
            given.save(path)
        return json.loads(_core.render_sequence(path, overrides, os.fspath(folder), device, report))


def convert(
    source: str | os.PathLike,
    path: str | os.PathLike,
    *,
    conventions: str = "",
    image_rows: int = 0,
    spacing_px: int = 0,
    at: Literal["mid", "a"] = "mid",
    exact: bool = False,
    device: str = "auto",
    progress: Progress = False,
) -> dict[str, Any]:
    """Converts a file of vectors to the format that the ending of `path` selects, as `gladstone convert` does.

    source: file of vectors of gladstone in any of the formats below, of OpenPIV, PIVlab, DaVis, Insight, Dantec, JPIV,
        PIVPy or any x, y, u, v; or truth.h5 of a case, for the true displacements of its dots or particles, or of its
        pixels.
    path: file to write: .h5, .csv, .nc, .mat, .dat (Tecplot), .vti or .vtp.
    conventions: conventions of a file of another program; default: the conventions of its format.
    image_rows: number of rows of the image, required for files that count y upwards from its lower edge.
    spacing_px: for truth.h5, distance between the columns and rows of the image at which the displacement is computed
        [px], with the position `at` as in `Truth.flow`. Default: 1 for .nc and .vti, which store grids; otherwise the
        dots or particles.
    exact: traces rays to every computed pixel, as in `Truth.flow`.

    Returns the `format` of the source, the number of `vectors`, the number of `valid` vectors, and the numbers of grid
    `columns` and `rows`.
    """
    check_choice("at", at, ("mid", "a"))
    check_whole("image_rows", image_rows, 0, 1_000_000)
    check_whole("spacing_px", spacing_px, 0, 10_000)
    with reporting(progress) as report:
        found = _core.convert(
            os.fspath(source), os.fspath(path), conventions, image_rows, spacing_px, at == "a", exact, device, report
        )
    return json.loads(found)


def views(
    case: str | os.PathLike, folder: str | os.PathLike | None = None, *, across: int = 5, refocus_mm: float | None = None
) -> dict[str, Any]:
    """Extracts the views of a plenoptic camera from a CASE folder, as `gladstone views` does.

    folder: folder to which FRAME/view_ROW_COLUMN.tif and views.json are written; default: CASE/views.
    across: number of views across the diameter of the stop.
    refocus_mm: also writes FRAME_refocused.tif, an image that is focused on the plane at this Z [mm].

    Returns the contents of views.json.
    """
    check_whole("across", across, 1, 99)
    place = os.path.join(os.fspath(case), "views") if folder is None else os.fspath(folder)
    return json.loads(_core.views(os.fspath(case), place, across, refocus_mm))


def report(
    folder: str | os.PathLike,
    path: str | os.PathLike | None = None,
    *,
    vectors: str | os.PathLike = "",
    repeats: Iterable[str | os.PathLike] = (),
    conventions: str = "",
    figures: str | os.PathLike = "",
    figure_format: str = "png",
    device: str = "auto",
    progress: Progress = False,
) -> str:
    """Writes the report of a study, a case or a measurement, as `gladstone report` does. Returns the findings as text.

    folder: RUN folder of a study, CASE folder, or folder of a measurement (setup and vectors without truth).
    path: .html (one file that works offline) or .md; default: report.html in the folder.
    vectors: for a CASE: file of vectors; default: the vectors of the CASE.
    repeats: for a measurement: vectors of repeated measurements of the same field.
    conventions: conventions of vectors of another program; default: the conventions of their format.
    figures: folder for the figures as separate files, in `figure_format` ("png", "svg" or "pdf").
    """
    check_choice("figure_format", figure_format, ("png", "svg", "pdf"))
    place = os.path.join(os.fspath(folder), "report.html") if path is None else os.fspath(path)
    check_report_ending(place)
    drawn = os.fspath(figures)
    if place.endswith(".md") and not drawn:
        drawn = os.path.splitext(place)[0] + "_figures"
    with reporting(progress) as report_progress:
        return _core.report(
            os.fspath(folder), place, os.fspath(vectors), [os.fspath(one) for one in repeats], conventions, drawn,
            figure_format, device, report_progress,
        )  # fmt: skip


def demo(folder: str | os.PathLike = "out/demo", *, device: str = "auto", progress: Progress = False) -> str:
    """Simulates the experiment of Rajendran et al. (2019) and writes the results into a folder, as `gladstone demo`
    does. Returns a summary."""
    with reporting(progress) as report_progress:
        return _core.demo(os.fspath(folder), device, report_progress)


def gallery(folder: str | os.PathLike = "out/gallery", *, device: str = "auto", progress: Progress = False) -> str:
    """Renders degraded particle images into a folder, as `gladstone gallery` does. Returns descriptions of the
    images."""
    with reporting(progress) as report_progress:
        return _core.gallery(os.fspath(folder), device, report_progress)


class Oracle(NamedTuple):
    """Comparison of a quantity computed by gladstone with its exact value; see `validate`."""

    name: str
    """Name of the quantity, with the unit if there is one."""
    source: str
    """Source of the exact value: author, year, equation."""
    measured: float
    """Value computed by gladstone."""
    exact: float
    """Exact value."""
    tolerance: float
    """Allowed difference."""
    relative: bool
    """Whether the tolerance is relative to the exact value."""
    passed: bool
    """Whether the difference is within the tolerance."""


def validate(*, device: str = "auto", progress: Progress = False) -> list[Oracle]:
    """Compares results of gladstone with exact solutions, as `gladstone validate` does. Returns one `Oracle` for each
    comparison."""
    with reporting(progress) as report_progress:
        return [Oracle(*row) for row in _core.oracles(device, report_progress)]
