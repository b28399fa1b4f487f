"""steep_gradients.py GLADSTONE [--steep] [--fields N] [--images own SynthPix OpenPIV] [--pivlab FOLDER]
[--synimagegen FOLDER]: errors in random smooth fields, on images like those of gladstone benchmark, and of the
generators of SynthPix and OpenPIV.

Fields: sums of six sines of 256 x 256 px with features of 5 to 100 px and peaks of 0 to 16 px, both drawn uniformly;
with --steep, features of 8 to 40 px, drawn logarithmically, and peaks of 4 to 16 px. Where the gradient would exceed
0.9 px/px, the peak is reduced. Alternately 0.035 and 0.075 particles per px, images of 3 px (e^-2), 8 bit. A particle
at p at mid-time is drawn at p - d(p)/2 and p + d(p)/2 by the peer's own function for one image, so that d(p) is its
exact displacement at mid-time. Pixel centres are at whole numbers in all generators:
    own (default): Gaussian particles integrated over the pixels, with the light of gladstone benchmark; no noise.
    SynthPix: img_gen_from_data, peaks of 100 to 250 grey levels, on 5 x 5 px each as it draws them, on a canvas 16 px
        wider at each side, as particles near its edge are moved onto it; no noise.
    OpenPIV: generate_particle_image of synimage/synimagegen.py, which the package does not contain (a clone of
        OpenPIV/openpiv-python); peaks of 40 to 100 % of its scale, integrated over the pixels; adds noise of 1.3 grey
        levels. It turns images upside down, which is undone, and omits particles at the border. Needs --synimagegen.
Programs: gladstone with its defaults and with steep_passes = 0; OpenPIV windef with 64, 32, 16 px, symmetric
deformation by splines of third order (0.26.1 has no option for affine windows); and PIVlab, see pivlab.py.

The error of a field is the mean length of the difference from the true displacement at the centre of the window over
all vectors, replaced ones and those at the border included; the last column is for those at least 32 px from the
border. The truth is the displacement at mid-time, except for PIVlab, which deforms the second image only: that of the
particle that is at the vector in the first image. The second table sorts the fields by their largest gradient, the
third one lists those in which the defaults of gladstone have a mean error above 0.05 px.

Needs: pip install openpiv==0.26.1 scipy tifffile; for SynthPix also synthpix==0.3.1 jax; for PIVlab GNU Octave with its
package image.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
from importlib.metadata import version

import numpy as np
import tifffile

import openpiv_windef
import pivlab
from scipy.special import erf

SIZE, MARGIN = 256, 16
BANDS = (0.0, 0.1, 0.2, 0.3, 0.5, 0.7, 0.91)  # of the largest gradient of a field [px/px]


class Field:
    """Sum of six sines; calling it with x and y [px] returns u and v [px]."""

    def __init__(self, index, is_steep):
        random = np.random.default_rng(index)
        size, peak = random.uniform(5.0, 100.0), random.uniform(0.0, 16.0)
        if is_steep:
            size, peak = np.exp(random.uniform(np.log(8.0), np.log(40.0))), random.uniform(4.0, 16.0)
        number = 1.0 / (size * (1.0 + random.random(6)))
        along, across, self.phase = (2.0 * np.pi * random.random(6) for _ in range(3))
        self.number = number[:, None] * np.stack([np.cos(along), np.sin(along)], axis=1)
        self.amplitude = np.stack([np.cos(across), np.sin(across)], axis=1)
        y, x = np.mgrid[:SIZE:2, :SIZE:2]
        self.amplitude *= peak / np.hypot(*self(x, y)).max()
        self.amplitude *= min(1.0, 0.9 / self.steepest(x, y))
        self.peak, self.gradient = np.hypot(*self(x, y)).max(), self.steepest(x, y)

    def angle(self, x, y):
        return np.multiply.outer(x, self.number[:, 0]) + np.multiply.outer(y, self.number[:, 1]) + self.phase

    def __call__(self, x, y):
        return np.moveaxis(np.sin(self.angle(x, y)) @ self.amplitude, -1, 0)

    def steepest(self, x, y):
        """Largest singular value of the gradient [px/px]."""
        slope = np.cos(self.angle(x, y))
        gradient = np.einsum("...k,ki,kj->...ij", slope, self.number, self.amplitude)
        return np.linalg.svd(gradient, compute_uv=False).max()

    def in_first_frame(self, x, y):
        """Returns the displacement of the particles whose position in the first frame is x, y."""
        u, v = self(x, y)
        for _ in range(60):
            u, v = self(x + 0.5 * u, y + 0.5 * v)
        return u, v


def draw_own(x, y, light, sigma=0.75, half=5):
    """Background of 25.5 and peaks of 76.5 to 153 grey levels, as gladstone benchmark (particle_pair.h)."""
    image = np.zeros((SIZE + 4 * half,) * 2)
    near = np.maximum(np.abs(x - 0.5 * (SIZE - 1)), np.abs(y - 0.5 * (SIZE - 1))) < 0.5 * SIZE + half - 0.5
    x, y, peak = x[near], y[near], 153.0 * (0.5 + 0.5 * light[near])
    steps = np.arange(-half, half + 1)

    def integrate(place):
        pixel = np.floor(place + 0.5).astype(int)[:, None] + steps
        edges = [erf((pixel + side - place[:, None]) / (np.sqrt(2.0) * sigma)) for side in (-0.5, 0.5)]
        return pixel + 2 * half, np.sqrt(0.5 * np.pi) * sigma * (edges[1] - edges[0])

    (column, across), (row, along) = integrate(x), integrate(y)
    light = peak[:, None, None] * along[:, :, None] * across[:, None, :]
    np.add.at(image, (row[:, :, None], column[:, None, :]), light)
    return 25.5 + image[2 * half:-2 * half, 2 * half:-2 * half]


def load_synthpix():
    """Returns the generator of SynthPix and its version."""
    folder = str(pathlib.Path(__file__).parent.resolve())
    sys.path.remove(folder)  # where synthpix.py would be taken for the package
    import jax.numpy as jnp
    from synthpix.generate import img_gen_from_data

    sys.path.append(folder)
    return lambda *particles: draw_synthpix(jnp, img_gen_from_data, *particles)


def draw_synthpix(jnp, img_gen_from_data, x, y, light):
    positions = jnp.stack([jnp.array(y + MARGIN), jnp.array(x + MARGIN)], axis=1)
    diameters = jnp.full(len(x), 1.5)  # of SynthPix: two standard deviations
    image = img_gen_from_data(positions, (SIZE + 2 * MARGIN,) * 2, 1.5, diameters, diameters,
                              jnp.array(100.0 + 150.0 * light), jnp.zeros(len(x)))
    return np.asarray(image)[MARGIN:-MARGIN, MARGIN:-MARGIN]


def draw_openpiv(synimagegen, x, y, light):
    near = (x > -8) & (x < SIZE + 8) & (y > -8) & (y < SIZE + 8)
    image = synimagegen.generate_particle_image(SIZE, SIZE, x[near], y[near], np.full(near.sum(), 3.0),
                                                (0.4 + 0.6 * light)[near], 8)
    return image[::-1]


def draw_pair(field, index, draw):
    random = np.random.default_rng(1000 + index)
    density, reach = (0.035, 0.075)[index % 2], SIZE + 2 * MARGIN
    x, y = random.uniform(-MARGIN, SIZE - 1 + MARGIN, (2, round(density * reach**2)))
    light, (u, v) = random.random(len(x)), field(x, y)
    np.random.seed(index)  # noise of OpenPIV's generator
    return [np.clip(np.rint(draw(x + sign * u, y + sign * v, light)), 0, 255).astype(np.uint8) for sign in (-0.5, 0.5)]


def measure_gladstone(program, folder, *sets):
    subprocess.run([program, "correlate", "a.tif", "b.tif", "-o", "own.csv", "--quiet", "--threads", "1", *sets],
                   cwd=folder, check=True, capture_output=True)
    table = np.genfromtxt(folder / "own.csv", delimiter=",", names=True)
    return [table[name] for name in ("x_px", "y_px", "u_px", "v_px")]


def measure_openpiv(a, b):
    try:
        return openpiv_windef.measure(a, b, (64, 32, 16))
    except ValueError:  # all vectors of a pass are rejected
        return None


def mean_error(truth, vectors):
    """Mean length of the errors, of all vectors and away from the border, and fraction of vectors without a value;
    infinite errors for a field without a result."""
    if vectors is None:
        return np.inf, np.inf, 1.0
    x, y, u, v = (np.asarray(one, float).ravel() for one in vectors)
    error = np.hypot(*(np.stack([u, v]) - truth(x, y)))
    inner = np.maximum(np.abs(x - 0.5 * (SIZE - 1)), np.abs(y - 0.5 * (SIZE - 1))) <= 0.5 * SIZE - 32
    return np.nanmean(error), np.nanmean(error[inner]), np.isnan(error).mean()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gladstone")
    parser.add_argument("--pivlab", help="clone of Shrediquette/PIVlab")
    parser.add_argument("--synimagegen", help="clone of OpenPIV/openpiv-python")
    parser.add_argument("--images", nargs="+", choices=("own", "SynthPix", "OpenPIV"), default=["own"])
    parser.add_argument("--fields", type=int, default=24)
    parser.add_argument("--steep", action="store_true")
    arguments = parser.parse_args()
    program = os.path.abspath(arguments.gladstone)
    generators = {}
    if "own" in arguments.images:
        generators["own"] = draw_own
    if "SynthPix" in arguments.images:
        generators["SynthPix"] = load_synthpix()
    if "OpenPIV" in arguments.images:
        if not arguments.synimagegen:
            parser.error("images of OpenPIV require --synimagegen")
        sys.path.append(os.path.join(arguments.synimagegen, "synimage"))
        import synimagegen
        generators["OpenPIV"] = lambda *particles: draw_openpiv(synimagegen, *particles)
    fields = [Field(index, arguments.steep) for index in range(arguments.fields)]
    errors = {}
    with tempfile.TemporaryDirectory() as temporary:
        for name, draw in generators.items():
            pairs = []
            for index, field in enumerate(fields):
                a, b = draw_pair(field, index, draw)
                folder = pathlib.Path(temporary) / f"{name}_{index}"
                folder.mkdir()
                tifffile.imwrite(folder / "a.tif", a)
                tifffile.imwrite(folder / "b.tif", b)
                pairs.append(folder)
                results = {"gladstone": measure_gladstone(program, folder),
                           "gladstone, steep_passes = 0": measure_gladstone(program, folder, "--set",
                                                                           "correlate.steep_passes=0"),
                           "OpenPIV windef, SciPy": measure_openpiv(a, b)}
                for code, vectors in results.items():
                    errors.setdefault((name, code), []).append(mean_error(field, vectors))
            if arguments.pivlab:
                for field, vectors in zip(fields, pivlab.measure(arguments.pivlab, pairs)):
                    errors.setdefault((name, "PIVlab, Octave"), []).append(mean_error(field.in_first_frame, vectors))
    print(f"gradients {min(f.gradient for f in fields):.2f} to {max(f.gradient for f in fields):.2f} px/px, OpenPIV "
          f"{version('openpiv')}, "
          + "".join(f"{name} {version(name)}, " for name in ("synthpix", "jax") if "SynthPix" in generators)
          + f"numpy {np.__version__}\n")
    print("| generator | program | median field | 90 % of the fields below | worst field | fields below 0.05 px | "
          "without a value | median away from the border |\n|---|---|---|---|---|---|---|---|")
    for (name, code), values in errors.items():
        error, inner, missing = np.array(values).T
        print(f"| {name} | {code} | {np.median(error):.4f} | {ninth(error):.3f} | {error.max():.3f} | "
              f"{(error < 0.05).sum()} | {100 * missing.mean():.2g} % | {np.median(inner):.4f} |")
    print_bands(fields, errors)
    print_worst(fields, errors)


def ninth(error):
    """Returns the smallest error that 90 % of the fields do not exceed."""
    return np.quantile(error, 0.9, method="higher")


def print_bands(fields, errors):
    gradient = np.array([field.gradient for field in fields])
    print("\n| gradient [px/px] | fields | generator | program | median field | 90 % of the fields below | worst field |"
          "\n|---|---|---|---|---|---|---|")
    for low, high in zip(BANDS[:-1], BANDS[1:]):
        band = (gradient >= low) & (gradient < high)
        for (name, code), values in errors.items() if band.any() else ():
            error = np.array(values)[band, 0]
            print(f"| {low} to {high} | {band.sum()} | {name} | {code} | {np.median(error):.4f} | {ninth(error):.3f} | "
                  f"{error.max():.3f} |")


def print_worst(fields, errors, least=0.05):
    print("\n| generator | field | mean error [px] | the same 32 px from the border | gradient [px/px] | peak [px] | "
          "waves from [px] |\n|---|---|---|---|---|---|---|")
    for (name, code), values in errors.items():
        for index, (error, inner, _) in enumerate(values):
            if code != "gladstone" or not error > least:
                continue
            field = fields[index]
            print(f"| {name} | {index} | {error:.3f} | {inner:.3f} | {field.gradient:.2f} | {field.peak:.1f} | "
                  f"{2 * np.pi / np.hypot(*field.number.T).max():.0f} |")


if __name__ == "__main__":
    main()
