"""tomography.py [--nodes 24] [--views 4,8,16] [--noise 0,0.01,0.05]: error of gladstone's SART with total
variation and of the SART of scikit-image on the same line integrals.

Two volumes in a cube: a Gaussian blob with a radius of a quarter of the half width, and a turbulent cube (200
random waves with the spectrum k^-5/3 exp(-k^2 / 32) under a window that tapers them to zero). Their line integrals are computed from these
formulae along parallel lines, in views over 180 degrees, and get normal noise with the given fraction of the largest one.
Both codes get these numbers.

scikit-image reconstructs slice by slice (iradon_sart): every number of iterations from 1 to 10 is tried, and the result
with the smallest error against the truth is printed, which no user could choose. gladstone runs with its defaults, and
with the best of five fixed weights of the total variation, chosen in the same way.
The error is the relative L2 error over the cylinder that all views see.

Needs: pip install scikit-image==0.26.0 numpy, and the package gladstone.
"""

import argparse
from importlib.metadata import version

import numpy as np
from skimage.transform import iradon_sart

import gladstone as gs


def blob(x, y, z):
    return np.exp(-(x**2 + y**2 + z**2) / 0.25**2)


def draw_waves():
    random = np.random.default_rng(1)
    waves = []
    while len(waves) < 200:
        wave = 4.0 * random.normal(size=3)
        if 1.5 <= np.linalg.norm(wave) <= 10.0:
            waves.append((wave, random.uniform(0.0, 2.0 * np.pi)))
    return waves


WAVES = draw_waves()


def turbulence(x, y, z):
    values = np.zeros(np.broadcast(x, y, z).shape)
    for wave, phase in WAVES:  # energy E(k) ~ k^-5/3 on shells of area k^2: amplitude k^(-5/6 - 1)
        amplitude = np.linalg.norm(wave) ** (-11.0 / 6.0)
        values += amplitude * np.cos(np.pi * (wave[0] * x + wave[1] * y + wave[2] * z) / 2.0 + phase)
    taper = np.clip((0.95 - np.maximum(np.hypot(x, z), np.abs(y))) / 0.45, 0.0, 1.0)
    return values * (0.5 - 0.5 * np.cos(np.pi * taper))


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


def reconstruct_peer(data, angles, truth, inside):
    """Best of 1 to 10 iterations of iradon_sart, slice by slice: error and number of iterations."""
    slices = [None] * data.shape[1]
    best = (np.inf, 0)
    for iteration in range(1, 11):
        slices = [iradon_sart(np.ascontiguousarray(data[:, j, :].T), angles, image=slices[j]) for j in range(len(slices))]
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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=24)
    parser.add_argument("--views", default="4,8,16")
    parser.add_argument("--noise", default="0,0.01,0.05")
    arguments = parser.parse_args()
    nodes = arguments.nodes
    position = np.arange(nodes) - nodes // 2
    circle = np.hypot(position[:, None], position[None, :]) <= nodes // 2 - 1
    inside = np.broadcast_to(circle[:, None, :], (nodes,) * 3)
    print(f"gladstone {gs.__version__}, scikit-image {version('scikit-image')}; {nodes}^3 nodes")
    print("| volume | noise | views | default | best weight | scikit-image, best iterations |")
    for name, function in (("blob", blob), ("turbulence", turbulence)):
        truth = sample(function, nodes)
        for noise in map(float, arguments.noise.split(",")):
            for views in map(int, arguments.views.split(",")):
                angles = 180.0 * np.arange(views) / views
                data = project(function, nodes, angles)
                data += noise * np.abs(data).max() * np.random.default_rng(7).normal(size=data.shape)
                default = relative_error(reconstruct_ours(data, angles, nodes), truth, inside)
                tuned = {weight: relative_error(reconstruct_ours(data, angles, nodes, weight), truth, inside)
                         for weight in WEIGHTS}
                best = min(tuned, key=tuned.get)
                peer, iterations = reconstruct_peer(data, angles, truth, inside)
                print(f"| {name} | {100 * noise:.0f} % | {views} | {default:.3f} | {tuned[best]:.3f} ({best:g}) | "
                      f"{peer:.3f} ({iterations}) |", flush=True)


if __name__ == "__main__":
    main()
