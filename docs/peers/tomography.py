"""tomography.py [--nodes 24] [--views 3,4,8,16] [--noise 0,0.01,0.05] [--figure FILE]: error of gladstone's SART with
total variation, and of the SART and the filtered back-projection of scikit-image, on the same line integrals.

Three volumes in a cube: a Gaussian blob with a radius of a quarter of the half width, and a cube of 10 mm from a direct
numerical simulation of turbulence (data/README.md), averaged over about two nodes and tapered to zero at the surface of
a cylinder: within the outer 10 % of the half width, or "faded" within 45 % of it. Their line integrals are computed
from the formula or the interpolated data along parallel lines, in views over 180 degrees, and get normal noise with the
given fraction of the largest one. All codes get these numbers.

scikit-image reconstructs slice by slice. Of its SART (iradon_sart) every number of iterations from 1 to 10 is tried,
and of its filtered back-projection (iradon) two filters; the result with the smallest error against the truth is
printed, which no user could choose. gladstone runs with its defaults, and with the best of five fixed weights of the
total variation, chosen in the same way. The error is the relative L2 error over the cylinder that all views see.
iradon_sart weights its corrections along each line with a Hamming window: it assumes that the middle varies most.

Needs: pip install scikit-image==0.26.0 numpy scipy h5py matplotlib, and the package gladstone.
"""

import argparse
import pathlib
from importlib.metadata import version

import h5py
import matplotlib

matplotlib.use("Agg")
import gladstone as gs
import matplotlib.pyplot as plt
import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates, spline_filter
from skimage.transform import iradon, iradon_sart


def blob(x, y, z):
    return np.exp(-(x**2 + y**2 + z**2) / 0.25**2)


def load_turbulence(nodes, margin):
    """The middle cube of 10 mm of the turbulence, as a function of -1 .. 1 along each side; averaged over a Gaussian
    with a standard deviation of one spacing of the nodes, so that they resolve it, and tapered to zero between
    0.95 - margin and 0.95."""
    with h5py.File(pathlib.Path(__file__).parents[2] / "data/fields/hbdt512_kepeak_slab128.h5") as file:
        slab = np.squeeze(file["Density_0001"][...]).astype(float)
    layers = min(slab.shape)
    density = gaussian_filter(slab, layers / nodes, mode=("nearest", "wrap", "wrap"))
    density = spline_filter(density - density.mean(), 3, mode="nearest")
    middle = [0.5 * (size - 1) for size in slab.shape]

    def turbulence(x, y, z):
        x, y, z = np.broadcast_arrays(x, y, z)
        at = [place + 0.5 * (layers - 1) * one for place, one in zip(middle, (z, y, x))]
        values = map_coordinates(density, at, order=3, mode="nearest", prefilter=False)
        taper = np.clip((0.95 - np.maximum(np.hypot(x, z), np.abs(y))) / margin, 0.0, 1.0)
        return values * (0.5 - 0.5 * np.cos(np.pi * taper))
    return turbulence


def sample(function, nodes):
    """Values [z, y, x] at the nodes; the axis of rotation is at node nodes // 2."""
    across, y = np.arange(nodes) - nodes // 2, np.arange(nodes) - 0.5 * (nodes - 1)
    half = nodes / 2.0
    return function(across[None, None, :] / half, y[None, :, None] / half, across[:, None, None] / half)


def project(function, nodes, angles):
    """Line integrals [view, y, across] in units of the spacing, by the midpoint rule with a quarter of it."""
    step, half = 0.25, nodes / 2.0
    along = (np.arange(round(nodes / step)) + 0.5) * step - half
    across, y = (np.arange(nodes) - nodes // 2)[None, :, None], (np.arange(nodes) - 0.5 * (nodes - 1))[:, None, None]
    views = []
    for angle in np.deg2rad(angles):
        x, z = np.cos(angle) * across + np.sin(angle) * along, -np.sin(angle) * across + np.cos(angle) * along
        views.append(step * function(x / half, y / half, z / half).sum(axis=2))
    return np.stack(views)


def reconstruct_filtered(data, angles, truth, inside):
    """Returns error and name of the better filter of filtered back-projection, ramp or Hann."""
    return min((relative_error(np.stack([iradon(data[:, j, :].T, angles, filter_name=name) for j in
                                         range(data.shape[1])], axis=1), truth, inside), name)
               for name in ("ramp", "hann"))


def reconstruct_peer(data, angles, truth, inside):
    """Returns the smallest error of 1 to 10 iterations of iradon_sart, slice by slice, and the number of iterations."""
    slices = [None] * data.shape[1]
    best = (np.inf, 0)
    for iteration in range(1, 11):
        slices = [iradon_sart(np.ascontiguousarray(data[:, j, :].T), angles, image=one) for j, one in enumerate(slices)]
        error = relative_error(np.stack(slices, axis=1), truth, inside)
        best = min(best, (error, iteration))
    return best


WEIGHTS = (0.0, 0.001, 0.003, 0.01, 0.03)


def reconstruct_ours(data, angles, nodes, tv_weight=None):
    middle = nodes // 2
    across, y = np.arange(nodes) - middle, np.arange(nodes) - 0.5 * (nodes - 1)
    origin, direction = [], []
    for angle in np.deg2rad(angles):
        right, along = np.array([np.cos(angle), 0.0, -np.sin(angle)]), np.array([np.sin(angle), 0.0, np.cos(angle)])
        grid = across[None, :, None] * right + y[:, None, None] * np.array([0.0, 1.0, 0.0])
        origin.append(grid.reshape(-1, 3))
        direction.append(np.broadcast_to(along, origin[-1].shape))
    view = np.repeat(np.arange(len(angles)), nodes * nodes)
    shift = 0.5 * (nodes - 1) - middle  # the middle node is at the origin along x and z
    volume = gs.reconstruct_lines(
        np.concatenate(origin), np.concatenate(direction), 1e-3 * data.reshape(-1), view, nodes=(nodes,) * 3,
        spacing_mm=1.0, center_mm=(shift, 0.0, shift), tv_weight=tv_weight,
    )  # fmt: skip
    return volume


def relative_error(volume, truth, inside):
    return np.linalg.norm((volume - truth)[inside]) / np.linalg.norm(truth[inside])


CODES = {"default": "gladstone, default", "best": "gladstone, best weight",
         "sart": "scikit-image SART, best iterations", "filtered": "scikit-image, filtered back-projection"}


def measure(function, nodes, views, noise):
    """Returns the error of each program, and the selected number of iterations or filter."""
    truth, angles = sample(function, nodes), 180.0 * np.arange(views) / views
    position = np.arange(nodes) - nodes // 2
    circle = np.hypot(position[:, None], position[None, :]) <= nodes // 2 - 1
    inside = np.broadcast_to(circle[:, None, :], (nodes,) * 3)
    data = project(function, nodes, angles)
    data += noise * np.abs(data).max() * np.random.default_rng(7).normal(size=data.shape)
    default = relative_error(reconstruct_ours(data, angles, nodes), truth, inside)
    best = min((relative_error(reconstruct_ours(data, angles, nodes, weight), truth, inside), weight)
               for weight in WEIGHTS)
    return {"default": (default, None), "best": best, "sart": reconstruct_peer(data, angles, truth, inside),
            "filtered": reconstruct_filtered(data, angles, truth, inside)}


def draw(table, path):
    """One panel per volume: error against views, a colour per noise and a line style per code."""
    volumes = list(dict.fromkeys(volume for volume, _, _ in table))
    noises = list(dict.fromkeys(noise for _, noise, _ in table))
    figure, axes = plt.subplots(1, len(volumes), figsize=(10, 4.2), sharey=True, layout="constrained")
    for panel, volume in zip(np.atleast_1d(axes), volumes):
        for colour, noise in zip(("#1f77b4", "#2ca02c", "#d62728"), noises):
            views = [key[2] for key in table if key[:2] == (volume, noise)]
            for code, style in (("default", "-o"), ("sart", "--s"), ("filtered", ":^")):
                errors = [table[volume, noise, one][code][0] for one in views]
                panel.plot(views, errors, style, color=colour, markersize=4,
                           label=f"{CODES[code]}, {100 * noise:g} % noise")
        panel.set(title=volume, xlabel="number of views", xscale="log", yscale="log", xticks=views)
        panel.set_xticklabels(views)
        panel.set_yticks([0.02, 0.05, 0.1, 0.2, 0.5], ["0.02", "0.05", "0.1", "0.2", "0.5"])
        panel.minorticks_off()
        panel.grid(alpha=0.3)
    np.atleast_1d(axes)[0].set_ylabel("relative L2 error")
    figure.legend(*panel.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=7)
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=24)
    parser.add_argument("--views", default="3,4,8,16")
    parser.add_argument("--noise", default="0,0.01,0.05")
    parser.add_argument("--figure")
    arguments = parser.parse_args()
    nodes, table = arguments.nodes, {}
    print(f"gladstone {gs.__version__}, scikit-image {version('scikit-image')}; {nodes}^3 nodes")
    print("| volume | noise | views | " + " | ".join(CODES.values()) + " |\n" + "|---" * (3 + len(CODES)) + "|")
    volumes = {"blob": blob, "turbulence": load_turbulence(nodes, 0.1),
               "faded turbulence": load_turbulence(nodes, 0.45)}
    for name, function in volumes.items():
        for noise in map(float, arguments.noise.split(",")):
            for views in map(int, arguments.views.split(",")):
                row = table[name, noise, views] = measure(function, nodes, views, noise)
                cells = [f"{error:.3f}" + ("" if choice is None else f" ({choice})") for error, choice in row.values()]
                print(f"| {name} | {100 * noise:g} % | {views} | " + " | ".join(cells) + " |", flush=True)
    if arguments.figure:
        draw(table, arguments.figure)


if __name__ == "__main__":
    main()
