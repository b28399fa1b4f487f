"""ray_truth.py GLADSTONE [--planes late kepeak]: error of the density from ray displacements.

Points every 8 and every 4 px are traced through both planes of data/fields (studies/cases/bench.toml: f/11, 256 x 256
px). Their displacements, and those by the aperture-averaged Eq. 9, serve as vectors. The density is compared with that
of the plane, averaged over the light cone: over discs whose diameter increases with the distance from the points, with
this distance as the weight, by Fourier transformation of the periodic plane. The constant of the integration, for which no region of these planes is suitable,
is fitted. Errors are standard deviations relative to that of the averaged density within the view.

Needs: pip install numpy scipy h5py
"""

import argparse
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np
from scipy.ndimage import map_coordinates
from scipy.special import j1

ROOT = pathlib.Path(__file__).resolve().parents[3]
FOCAL_MM, F_NUMBER, Z_A_MM, Z_D_MM, THICKNESS_MM, SPACING_MM, SCALE = 105.0, 11.0, 750.0, 250.0, 10.0, 0.0625, 1.225


def average_over_cone(plane):
    """Density of the plane, averaged over the light cone: Gauss-Legendre quadrature over the thickness."""
    number = np.fft.fftfreq(len(plane), SPACING_MM)
    number = np.hypot(number[:, None], number[None, :])
    points, weights = np.polynomial.legendre.leggauss(8)
    distance = Z_D_MM + 0.5 * THICKNESS_MM * points
    transfer = 0.0
    for one, weight in zip(distance, weights * distance / np.sum(weights * distance)):
        argument = np.pi * number * FOCAL_MM / F_NUMBER * one / (Z_A_MM + Z_D_MM)
        transfer += weight * np.where(argument > 0, 2.0 * j1(argument) / np.where(argument > 0, argument, 1.0), 1.0)
    return np.fft.ifft2(np.fft.fft2(plane) * transfer).real


def sample(plane, x_mm, y_mm):
    """Values [y, x] of the periodic plane, whose middle is on the axis, by cubic splines."""
    middle = 0.5 * (len(plane) - 1)
    rows, columns = np.meshgrid(y_mm / SPACING_MM + middle, x_mm / SPACING_MM + middle, indexing="ij")
    return map_coordinates(plane, [rows, columns], order=3, mode="grid-wrap")


def measure(program, folder, name, pitch_px):
    """Errors against the averaged density from rays and from the aperture-averaged theory, and of rays against the
    density itself."""
    def run(*words):
        subprocess.run([program, *map(str, words), "--quiet", "--threads", "1"], cwd=folder, check=True)

    file = ROOT / f"data/fields/hbdt512_{name}_slice.h5"
    sets = [f'medium.field.file="{file}"', 'target.arrangement="regular"', "target.dot_diameter_px=0",
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
    vectors = vectors[np.ix_(inside.any(axis=1), inside.any(axis=0))].reshape(-1, 6)
    middle = vectors[np.argmin(np.hypot(*(vectors[:, :2] - 127.5).T))]
    to_mm = 0.01 / (FOCAL_MM / (Z_A_MM + Z_D_MM - FOCAL_MM)) * Z_A_MM / (Z_A_MM + Z_D_MM)
    x, y = (middle[0] - 127.5) * to_mm, -(middle[1] - 127.5) * to_mm
    density = []
    for first in (2, 4):
        np.savetxt(folder / "vectors.csv", vectors[:, [0, 1, first, first + 1]], delimiter=",",
                   header="x_px,y_px,u_px,v_px", comments="")
        run("reconstruct", "case", "--vectors", "vectors.csv", "--reference", f"{x - .1},{y - .1},{x + .1},{y + .1}",
            "-o", "density.h5", "--no-figures")
        with h5py.File(folder / "density.h5") as result:
            density.append(result["density_kg_m3"][...])
            x_mm, y_mm = result["x_mm"][...], result["y_mm"][...]
    with h5py.File(file) as data:
        plane = SCALE * np.squeeze(data["Density_0001"][...]).astype(float)
    averaged = sample(average_over_cone(plane), x_mm, y_mm)
    differences = density[0] - averaged, density[1] - averaged, density[0] - sample(plane, x_mm, y_mm)
    return [np.std(one) / np.std(averaged) for one in differences]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--planes", nargs="+", default=["late", "kepeak"])
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    print("| plane | a vector every | rays against the averaged density | aperture-averaged Eq. 9 against it | "
          "rays against the density |\n|---|---|---|---|---|")
    for name in arguments.planes:
        for pitch_px in (8, 4):
            with tempfile.TemporaryDirectory() as temporary:
                errors = measure(program, pathlib.Path(temporary), name, pitch_px)
            cells = " | ".join(f"{100 * one:.2f} %" for one in errors)
            print(f"| {name} | {pitch_px} px | {cells} |", flush=True)


if __name__ == "__main__":
    main()
