"""turbulence_views.py GLADSTONE [--views 4 8] [--pixels 192]: error of the volume of a turbulence from rendered views.

The flow is a cube of 10 mm of the direct numerical simulation in data/fields, averaged over a Gaussian with a standard
deviation of 0.42 mm, as in docs/peers/tomography.py, and tapered to the mean density within the outer 0.5 mm of a
cylinder. It is rendered in several views over 180 degrees (f/32, pixels of 0.064 mm in the flow, no noise), correlated,
and reconstructed. Prints the relative L2 error of the density difference within the cylinder, from the vectors and from
the displacement of light rays (--ray-truth).

Needs: pip install numpy scipy h5py
"""

import argparse
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates, spline_filter

ROOT = pathlib.Path(__file__).resolve().parents[3]
HALF_MM, SPACING_MM, NODES, SCALE = 5.0, 0.25, 49, 1.225

SETUP = """
[camera]
pixels = [{pixels}, {pixels}]
pixel_pitch_um = 10.0
[lens]
focal_length_mm = 105.0
f_number = 32.0
[geometry]
z_a_mm = 750.0
z_d_mm = 250.0
[medium]
ambient_density_kg_m3 = 1.225
[medium.field]
kind = "file"
file = "flow.nrrd"
[target]
dots_per_32px_window = 20.0
[render]
rays_per_dot = 128
[correlate]
window_px = [32, 16, 12]
"""


def write_flow(path):
    """Writes the tapered turbulence, 1.225 kg/m^3 outside."""
    with h5py.File(ROOT / "data/fields/hbdt512_kepeak_slab128.h5") as file:
        slab = SCALE * np.squeeze(file["Density_0001"][...]).astype(float)
    layers = min(slab.shape)
    density = gaussian_filter(slab, layers / 24, mode=("nearest", "wrap", "wrap"))
    density = spline_filter(density - density.mean(), 3, mode="nearest")
    along = (np.arange(NODES) - 0.5 * (NODES - 1)) * SPACING_MM / HALF_MM
    z, y, x = np.meshgrid(along, along, along, indexing="ij")
    middle = [0.5 * (size - 1) for size in slab.shape]
    at = [place + 0.5 * (layers - 1) * one for place, one in zip(middle, (z, y, x))]
    taper = np.clip((0.95 - np.maximum(np.hypot(x, z), np.abs(y))) / 0.1, 0.0, 1.0)
    values = 1.225 + map_coordinates(density, at, order=3, mode="nearest", prefilter=False) * (
        0.5 - 0.5 * np.cos(np.pi * taper))  # fmt: skip
    sizes, spacings = " ".join([str(NODES)] * 3), " ".join([str(SPACING_MM)] * 3)
    header = (f"NRRD0004\ntype: float\ndimension: 3\nsizes: {sizes}\nspacings: {spacings}\n"
              'units: "mm" "mm" "mm"\nsample units: "kg/m^3"\nendian: little\nencoding: raw\n\n')
    path.write_bytes(header.encode() + values.astype("<f4").tobytes())


def relative_error(path):
    """Relative L2 error of the density difference within the cylinder."""
    with h5py.File(path) as file:
        density, truth = file["density_kg_m3"][...], file["truth_kg_m3"][...]
        x, y, z = (file[f"{name}_mm"][...] for name in "xyz")
    inside = (np.hypot(x[None, None, :], z[:, None, None]) < HALF_MM) & (np.abs(y)[None, :, None] < HALF_MM)
    return np.linalg.norm((density - truth)[inside]) / np.linalg.norm((truth - 1.225)[inside])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--views", type=int, nargs="+", default=[4, 8])
    parser.add_argument("--pixels", type=int, default=192)
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    print("| views | vectors | light rays |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)

        def run(*words):
            subprocess.run([program, *map(str, words), "--quiet"], cwd=folder, check=True, capture_output=True)

        write_flow(folder / "flow.nrrd")
        (folder / "flow.toml").write_text(SETUP.format(pixels=arguments.pixels))
        for views in arguments.views:
            run("tomography", "flow.toml", "--views", views, "-o", f"views_{views}")
            cases = [f"case_{views}_{i}" for i in range(views)]
            for i, case in enumerate(cases):
                run("render", f"views_{views}/view_{i:02}.toml", "-o", case)
                run("correlate", case)
            cells = []
            for option in ((), ("--ray-truth",)):
                run("tomography", *cases, *option, "--reference", "left", "--reference", "right", "-o", "volume.h5",
                    "--no-figures")  # fmt: skip
                cells.append(f"{relative_error(folder / 'volume.h5'):.3f}")
            print(f"| {views} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
