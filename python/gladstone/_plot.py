"""Figures drawn by matplotlib, which is required only for these figures."""

from __future__ import annotations

import numpy as np


def plot_report(report):
    """Draws a comparison: maps on the left, the error budget on the right."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 4, figsize=(15, 6.5), layout="constrained")
    maps = (("true", report.truth_px), ("measured", report.measured_px), ("measured - true", report.error_px))
    for row, component in enumerate("uv"):
        largest = max(_largest(report.truth_px[..., row]), _largest(report.measured_px[..., row], 99))
        for column, (title, values) in enumerate(maps):
            limit = _largest(values[..., row], 99) if column == 2 else largest
            _map(figure, axes[row, column], report.position_px, values[..., row], f"{title} {component} [px]", limit)
    _histogram(axes[0, 3], report)
    _budget(axes[1, 3], report)
    return figure


def plot_field(field):
    """Draws maps of both components of a displacement field with arrows; masked and invalid vectors are omitted."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4), layout="constrained")
    position = np.stack([field.x, field.y], axis=-1)
    for axis, name, direction in zip(axes, "uv", ("to the right", "downwards")):
        values = np.where(field.valid, getattr(field, name), np.nan)
        _map(figure, axis, position, values, f"{name}, {direction} [px]", _largest(values))
        _arrows(axis, field)
    return figure


def _arrows(axis, field, most: int = 20) -> None:
    """Draws arrows of valid vectors, at most about `most` along each direction. The length of an arrow is relative to
    the largest vector."""
    if len(field.shape) == 2:
        every = tuple(slice(None, None, -(-size // most)) for size in field.shape)
    else:
        every = (slice(None, None, -(-len(field) // most**2) or 1),)
    shown = field.valid[every]
    x, y, u, v = (values[every][shown] for values in (field.x, field.y, field.u, field.v))
    axis.quiver(x, y, u, v, angles="xy", width=0.004)


def plot_statistics(statistics):
    """Draws maps of mean and standard deviation over a sequence: u in the upper row, v in the lower row."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 2, figsize=(9.5, 8), layout="constrained")
    position = np.stack([statistics["x_px"], statistics["y_px"]], axis=-1)
    for row, name in zip(axes, "uv"):
        for axis, (key, title) in zip(row, (("mean", "mean"), ("rms", "standard deviation"))):
            values = statistics[f"{name}_{key}_px"]
            _map(figure, axis, position, values, f"{title} of {name} [px]", _largest(values))
    return figure


def plot_images(case):
    """Draws both frames of a case on one grey scale."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.5), layout="constrained")
    names = ("frame A", "frame B") if case.is_piv else ("reference image", "measurement image")
    for axis, name, image in zip(axes, names, case.images):
        drawn = axis.imshow(image, cmap="gray", vmin=0, vmax=np.max(case.images))
        axis.set(title=name, xlabel="column [px]", ylabel="row [px]")
    figure.colorbar(drawn, ax=axes, shrink=0.8, label="grey level [DN]")
    return figure


def _largest(values, percentile: float = 100.0) -> float:
    """Returns a percentile of the magnitudes; 0 if there are no numbers."""
    finite = np.abs(values[np.isfinite(values)])
    return float(np.percentile(finite, percentile)) if finite.size else 0.0


def _map(figure, axis, position, values, title: str, limit: float) -> None:
    """Draws values on a grid as cells and scattered values as points; the colour scale is symmetric about 0."""
    limit = limit if limit > 0 else 1.0
    x, y = position[..., 0], position[..., 1]
    style = {"cmap": "RdBu_r", "vmin": -limit, "vmax": limit}
    drawn = axis.pcolormesh(x, y, values, **style) if values.ndim == 2 else axis.scatter(x, y, c=values, s=4, **style)
    axis.set(title=title, xlabel="column [px]", ylabel="row [px]", aspect="equal")
    if np.size(y):
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
    axis.locator_params(axis="x", nbins=4)


def plot_three_components(result):
    """Draws maps of three displacement components without invalid nodes, and of the residual."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 4, figsize=(17, 3.8), layout="constrained")
    for k, name in enumerate(("u, along X", "v, along Y", "w, along Z")):
        values = np.where(result.valid, result.displacement_mm[..., k], np.nan)
        limit = _largest(values) or 1.0
        _plane(figure, axes[k], result.x_mm, result.y_mm, values, f"{name} [mm]",
               {"cmap": "RdBu_r", "vmin": -limit, "vmax": limit})  # fmt: skip
    _plane(figure, axes[3], result.x_mm, result.y_mm, result.residual_px, "residual [px]", {"vmin": 0.0})
    return figure


def plot_volume(result):
    """Draws the density in the three mid-planes of a volume, and below it the error for rendered cases."""
    import matplotlib.pyplot as plt

    rows = [("density", result.density, {"vmin": np.nanmin(result.density), "vmax": np.nanmax(result.density)})]
    if result.truth is not None:
        largest = _largest(result.error) or 1.0
        rows.append(("error", result.error, {"cmap": "RdBu_r", "vmin": -largest, "vmax": largest}))
    figure, axes = plt.subplots(len(rows), 3, figsize=(13.5, 3.8 * len(rows)), layout="constrained", squeeze=False)
    axis = {"x": result.x_mm, "y": result.y_mm, "z": result.z_mm}
    for line, (title, values, style) in zip(axes, rows):
        middle = [size // 2 for size in values.shape]
        planes = (("x", "y", "z", values[middle[0]]), ("z", "y", "x", values[:, :, middle[2]].T),
                  ("x", "z", "y", values[:, middle[1]]))  # fmt: skip
        for cell, (across, up, normal, plane) in zip(line, planes):
            place = axis[normal][len(axis[normal]) // 2]
            text = f"{title} at {normal} = {place:.4g} mm [kg/m$^3$]"
            _plane(figure, cell, axis[across], axis[up], plane, text, style, (across, up))
    return figure


def _plane(figure, axis, x_mm, y_mm, values, title: str, style: dict, names=("x", "y")) -> None:
    """Draws [rows, columns] values over two axes in mm."""
    drawn = axis.pcolormesh(x_mm, y_mm, values, **style)
    axis.set(title=title, xlabel=f"{names[0]} [mm]", ylabel=f"{names[1]} [mm]", aspect="equal")
    figure.colorbar(drawn, ax=axis, shrink=0.8)


def plot_density(result):
    """Draws maps of a density and its uncertainty; for a rendered case, also of the true density and the error."""
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
        _plane(figure, axis, result.x_mm, result.y_mm, values, f"{title} [kg/m$^3$]", style)
    return figure
