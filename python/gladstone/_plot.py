"""Figures by matplotlib, which is needed for these only."""

from __future__ import annotations

import numpy as np


def plot_report(report):
    """Draws a comparison: maps on the left, the error budget on the right."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 4, figsize=(15, 6.5), layout="constrained")
    maps = (("true", report.truth_px), ("measured", report.measured_px), ("measured - true", report.error_px))
    for row, component in enumerate("uv"):
        largest = np.nanmax(np.abs(report.truth_px[..., row])) if report.truth_px.size else 1.0
        for column, (title, values) in enumerate(maps):
            limit = np.nanpercentile(np.abs(values[..., row]), 99) if column == 2 else largest
            _map(figure, axes[row, column], report, values[..., row], f"{title} {component} [px]", limit)
    _histogram(axes[0, 3], report)
    _budget(axes[1, 3], report)
    return figure


def _map(figure, axis, report, values, title: str, limit: float) -> None:
    limit = limit if np.isfinite(limit) and limit > 0 else 1.0
    x, y = report.position_px[..., 0], report.position_px[..., 1]
    style = {"cmap": "RdBu_r", "vmin": -limit, "vmax": limit}
    drawn = axis.pcolormesh(x, y, values, **style) if values.ndim == 2 else axis.scatter(x, y, c=values, s=4, **style)
    axis.set(title=title, xlabel="column [px]", ylabel="row [px]", aspect="equal")
    axis.set_ylim(np.max(y), np.min(y))
    figure.colorbar(drawn, ax=axis, shrink=0.8)


def _histogram(axis, report) -> None:
    errors = report.error_px[report.mask]
    for component, name in enumerate("uv"):
        axis.hist(errors[:, component], bins=60, histtype="step", label=name)
    axis.set(title="error against ray truth", xlabel="measured - true [px]", ylabel="vectors")
    axis.legend()


def _budget(axis, report) -> None:
    terms = {name: term["rms_px"] for name, term in report.budget.items() if term["rms_px"] is not None}
    axis.barh(list(terms)[::-1], list(terms.values())[::-1])
    axis.set(title="error budget", xlabel="rms [px]")


def plot_density(result):
    """Draws maps of a density and its uncertainty, and for a rendered case of the true density and the error."""
    import matplotlib.pyplot as plt

    maps = [("density", result.density, {}), ("standard uncertainty", result.sigma, {"vmin": 0.0})]
    if result.truth is not None:
        limits = {"vmin": np.nanmin(result.truth), "vmax": np.nanmax(result.truth)}
        largest = np.nanmax(np.abs(result.error))
        maps[0] = ("density", result.density, limits)
        maps.append(("true density", result.truth, limits))
        maps.append(("error", result.error, {"cmap": "RdBu_r", "vmin": -largest, "vmax": largest}))
    figure, axes = plt.subplots(1, len(maps), figsize=(4.5 * len(maps), 3.8), layout="constrained")
    for axis, (title, values, style) in zip(axes, maps):
        drawn = axis.pcolormesh(result.x_mm, result.y_mm, values, **style)
        axis.set(title=f"{title} [kg/m$^3$]", xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
        figure.colorbar(drawn, ax=axis, shrink=0.8)
    return figure
