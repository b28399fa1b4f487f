"""ray_truth.py GLADSTONE [--planes late kepeak] [--pitches 8 4] [--factors 1] [--f-numbers 11]: error of the density
from ray displacements.

Points every 8 and every 4 px are traced through both planes of data/fields (studies/cases/bench.toml: f/11, 256 x 256
px), whose density is multiplied by the factors. Their displacements, and those by the aperture-averaged Eq. 9, serve as
vectors. The density is compared with that of the plane, averaged over the light cone: over discs whose diameter
increases with the distance from the points, with this distance as the weight, by Fourier transformation of the periodic
plane. The constant of the integration, for which no region of these planes is suitable, is fitted. Errors are standard
deviations relative to that of the averaged density within the view.

Two more displacements separate the causes: straight rays that are deflected once, in the mid-plane, where they meet it
after this deflection. They differ from Eq. 9 by the place of the deflection only, and from light rays by the thickness
of the medium. The last column but one is the error of the displacement of light rays without its second-order part: the
density less (Z_A Z_D / (Z_A + Z_D)) (K L / 2 n_0) |grad rho|^2, averaged over the aperture, which no vector contains.

Needs: pip install numpy scipy h5py
"""

import argparse
import itertools
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np
from scipy.ndimage import map_coordinates, spline_filter
from scipy.special import j1

ROOT = pathlib.Path(__file__).resolve().parents[3]
FOCAL_MM, Z_A_MM, Z_D_MM, THICKNESS_MM, SPACING_MM, SCALE = 105.0, 750.0, 250.0, 10.0, 0.0625, 1.225
MAGNIFICATION, PIXEL_MM = FOCAL_MM / (Z_A_MM + Z_D_MM - FOCAL_MM), 0.01
GLADSTONE_DALE, AMBIENT_INDEX = 2.26e-4, 1.0 + 2.26e-4 * 1.225


def average_over_cone(plane, f_number):
    """Density of the plane, averaged over the light cone: Gauss-Legendre quadrature over the thickness."""
    number = np.fft.fftfreq(len(plane), SPACING_MM)
    number = np.hypot(number[:, None], number[None, :])
    points, weights = np.polynomial.legendre.leggauss(8)
    distance = Z_D_MM + 0.5 * THICKNESS_MM * points
    transfer = 0.0
    for one, weight in zip(distance, weights * distance / np.sum(weights * distance)):
        argument = np.pi * number * FOCAL_MM / f_number * one / (Z_A_MM + Z_D_MM)
        transfer += weight * np.where(argument > 0, 2.0 * j1(argument) / np.where(argument > 0, argument, 1.0), 1.0)
    return np.fft.ifft2(np.fft.fft2(plane) * transfer).real


def sample(plane, x_mm, y_mm):
    """Values [y, x] of the periodic plane, whose middle is on the axis, by cubic splines."""
    middle = 0.5 * (len(plane) - 1)
    rows, columns = np.meshgrid(y_mm / SPACING_MM + middle, x_mm / SPACING_MM + middle, indexing="ij")
    return map_coordinates(plane, [rows, columns], order=3, mode="grid-wrap")


def deflections(plane):
    """Deflection (x, y) [rad] by the thickness of the medium at the nodes of the plane."""
    number = 2.0j * np.pi * np.fft.fftfreq(len(plane), SPACING_MM)
    spectrum = GLADSTONE_DALE * THICKNESS_MM / AMBIENT_INDEX * np.fft.fft2(plane)
    return np.stack([np.fft.ifft2(number[None, :] * spectrum).real, np.fft.ifft2(number[:, None] * spectrum).real])


def deflect_once(plane, place_px, f_number):
    """Displacement [px] of points, mean over the rays through the aperture that are deflected in the mid-plane."""
    angles = [spline_filter(one, mode="grid-wrap") for one in deflections(plane)]
    pupil = 0.5 * FOCAL_MM / f_number
    disc = 1.6 * pupil * Z_D_MM / (Z_A_MM + Z_D_MM) * np.linspace(-1.0, 1.0, 181)  # with rays outside of the cone
    middle, result = 0.5 * (len(plane) - 1), []
    for x, y in (place_px - 127.5) * PIXEL_MM / MAGNIFICATION * (1, -1):
        at_x, at_y = np.meshgrid(x * Z_A_MM / (Z_A_MM + Z_D_MM) + disc, y * Z_A_MM / (Z_A_MM + Z_D_MM) + disc)
        angle_x, angle_y = (map_coordinates(one, [at_y / SPACING_MM + middle, at_x / SPACING_MM + middle], order=3,
                                            mode="grid-wrap", prefilter=False) for one in angles)
        enters = np.hypot(at_x + Z_A_MM * ((at_x - x) / Z_D_MM + angle_x),
                          at_y + Z_A_MM * ((at_y - y) / Z_D_MM + angle_y)) < pupil
        result.append([angle_x[enters].mean(), -angle_y[enters].mean()])
    return -MAGNIFICATION * Z_D_MM / PIXEL_MM * np.array(result)


def second_order(plane, f_number):
    """Returns the second-order part of the measured density at the nodes of the plane."""
    lever = Z_A_MM * Z_D_MM / (Z_A_MM + Z_D_MM)
    squares = average_over_cone((deflections(plane) ** 2).sum(axis=0), f_number)
    return -0.5 * lever * AMBIENT_INDEX / (GLADSTONE_DALE * THICKNESS_MM) * squares


def measure(program, folder, name, pitch_px, factor, f_number):
    """Rms gradient of the displacement of light rays [px/px], errors against the averaged density by the columns of the
    table, and of light rays against the density itself."""
    def run(*words):
        subprocess.run([program, *map(str, words), "--quiet", "--threads", "1"], cwd=folder, check=True)

    file = ROOT / f"data/fields/hbdt512_{name}_slice.h5"
    sets = [f'medium.field.file="{file}"', f"medium.field.scale={factor * SCALE}", f"lens.f_number={f_number}",
            'target.arrangement="regular"', "target.dot_diameter_px=0",
            f"target.dots_per_32px_window={(32 / pitch_px) ** 2}"]
    run("render", ROOT / "studies/cases/bench.toml", "-o", "case", *(word for one in sets for word in ("--set", one)))
    with h5py.File(folder / "case/truth.h5") as truth:
        place, displacement, theory = (truth[f"dots/{key}_px"][...]
                                       for key in ("reference", "displacement", "eq9_cone"))
    lattice = np.round(place / pitch_px - place[0] / pitch_px).astype(int)
    lattice -= lattice.min(axis=0)
    columns, rows = lattice.max(axis=0) + 1
    vectors = np.full((rows, columns, 6), np.nan)
    vectors[lattice[:, 1], lattice[:, 0]] = np.hstack([place, displacement, theory])
    inside = (np.abs(vectors[..., :2] - 127.5) < 128.0).all(axis=2)
    vectors = vectors[np.ix_(inside.any(axis=1), inside.any(axis=0))]
    slopes = np.stack([np.gradient(vectors[..., 2:4], pitch_px, axis=axis) for axis in (0, 1)])
    gradient = np.sqrt(np.mean(np.sum(slopes**2, axis=(0, 3))))
    vectors = vectors.reshape(-1, 6)
    with h5py.File(file) as data:
        plane = factor * SCALE * np.squeeze(data["Density_0001"][...]).astype(float)
    vectors = np.hstack([vectors, deflect_once(plane, vectors[:, :2], f_number)])
    middle = vectors[np.argmin(np.hypot(*(vectors[:, :2] - 127.5).T))]
    to_mm = PIXEL_MM / MAGNIFICATION * Z_A_MM / (Z_A_MM + Z_D_MM)
    x, y = (middle[0] - 127.5) * to_mm, -(middle[1] - 127.5) * to_mm
    density = []
    for first in (2, 4, 6):
        np.savetxt(folder / "vectors.csv", vectors[:, [0, 1, first, first + 1]], delimiter=",",
                   header="x_px,y_px,u_px,v_px", comments="")
        run("reconstruct", "case", "--vectors", "vectors.csv", "--reference", f"{x - .1},{y - .1},{x + .1},{y + .1}",
            "-o", "density.h5", "--no-figures")
        with h5py.File(folder / "density.h5") as result:
            density.append(result["density_kg_m3"][...])
            x_mm, y_mm = result["x_mm"][...], result["y_mm"][...]
    averaged = sample(average_over_cone(plane, f_number), x_mm, y_mm)
    excess = sample(second_order(plane, f_number), x_mm, y_mm)
    differences = [*(one - averaged for one in density), density[0] - averaged - excess,
                   density[0] - sample(plane, x_mm, y_mm)]
    return gradient, [np.std(one) / np.std(averaged) for one in differences]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--planes", nargs="+", default=["late", "kepeak"])
    parser.add_argument("--pitches", nargs="+", type=int, default=[8, 4])
    parser.add_argument("--factors", nargs="+", type=float, default=[1.0])
    parser.add_argument("--f-numbers", nargs="+", type=float, default=[11.0])
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    print("| plane | factor | f-number | a vector every | gradient [px/px] | light rays | aperture-averaged Eq. 9 | "
          "one deflection in the mid-plane | light rays without the second order | "
          "light rays against the density itself |\n" + "|---" * 10 + "|")
    for name, factor, f_number, pitch_px in itertools.product(arguments.planes, arguments.factors, arguments.f_numbers,
                                                              arguments.pitches):
        with tempfile.TemporaryDirectory() as temporary:
            gradient, errors = measure(program, pathlib.Path(temporary), name, pitch_px, factor, f_number)
        cells = " | ".join(f"{100 * one:.2f} %" for one in errors)
        print(f"| {name} | {factor:g} | {f_number:g} | {pitch_px} px | {gradient:.4f} | {cells} |", flush=True)


if __name__ == "__main__":
    main()
