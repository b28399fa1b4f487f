"""peer_abel.py GLADSTONE: errors of the Abel inversion of `gladstone reconstruct --axisymmetric` and of PyAbel.

The density difference is A exp(-r^2/s^2), sampled at n radii from 0 to 4 s. Its projection along the line of sight is
sqrt(pi) s A exp(-x^2/s^2), an Abel pair. gladstone inverts the displacement, which is proportional to the derivative of
the projection (Eq. 9). PyAbel's three-point method (abel.dasch.three_point_transform) inverts the projection itself,
which a BOS measurement does not have; with noise, it is integrated from the same displacement by the trapezoidal rule.

First table: rms error over the radii relative to A, exact displacement and exact projection.
Second table: normal noise of each vector, 200 rows with n = 141 radii on either side. The noise is 2 % of the largest
displacement on one side, on the other side the same or four times as much. For gladstone: rms error with the standard
uncertainty of every vector, which weights both sides of the axis, and with equal uncertainties; and the fraction of
errors within one sigma_rho (ideal: 0.683). The errors are those of all radii but the last, where the density is the
ambient one.

Needs: pip install numpy h5py PyAbel==0.9.1
"""

import argparse
import pathlib
import subprocess
import tempfile
from importlib.metadata import version

import h5py
import numpy as np
from abel.dasch import three_point_transform

AMPLITUDE, AMBIENT = -0.5, 1.225  # [kg/m^3]
STEP_PX, PITCH_MM = 4, 0.01  # distance between vectors, pixel pitch
FOCAL_MM, Z_A_MM, Z_D_MM, DALE = 105.0, 750.0, 250.0, 2.26e-4

SETUP = """experiment = "bos"
[camera]
pixels = [{columns}, {rows}]
pixel_pitch_um = {pitch}
[lens]
focal_length_mm = {focal}
[geometry]
z_a_mm = {z_a}
z_d_mm = {z_d}
[medium]
gladstone_dale = {dale}
ambient_density_kg_m3 = {ambient}
thickness_mm = 10.0
"""


def magnification():
    return FOCAL_MM / (Z_A_MM + Z_D_MM - FOCAL_MM)


def radii(n):
    """Radii in the mid-plane of the medium [mm]."""
    return np.arange(n) * STEP_PX * PITCH_MM / (magnification() * (Z_A_MM + Z_D_MM) / Z_A_MM)


def exact(n):
    """Returns radii [mm], density difference and its projection [kg/m^3, kg/m^3 mm], derivative of the projection."""
    r = radii(n)
    s = r[-1] / 4
    density = AMPLITUDE * np.exp(-(r / s)**2)
    projection = np.sqrt(np.pi) * s * density
    return r, density, projection, -2 * r / s**2 * projection


def sensitivity():
    """Returns the ratio of the dots' displacement to the negative derivative of the projection [px/(kg/m^3)]."""
    return magnification() * Z_D_MM * DALE / ((1 + DALE * AMBIENT) * PITCH_MM)


def invert(program, folder, u, sigma):
    """Returns density difference and sigma_rho [rows, n] from displacements [rows, 2 n - 1] with their uncertainty."""
    rows, columns = u.shape
    y, x = STEP_PX * np.mgrid[:rows, :columns]
    table = np.column_stack([column.ravel() for column in (x, y, u, 0 * u, sigma, sigma)])
    np.savetxt(folder / "v.csv", table, "%.17g", ",", header="x_px,y_px,u_px,v_px,sigma_u_px,sigma_v_px", comments="")
    size = {"columns": STEP_PX * (columns - 1) + 1, "rows": STEP_PX * (rows - 1) + 1}
    (folder / "setup.toml").write_text(SETUP.format(**size, pitch=1e3 * PITCH_MM, focal=FOCAL_MM, z_a=Z_A_MM,
                                                    z_d=Z_D_MM, dale=DALE, ambient=AMBIENT))
    subprocess.run([program, "reconstruct", "setup.toml", "--vectors", "v.csv", "--axisymmetric", "--axis", "x=0",
                    "--overlap", "0", "--no-figures", "-o", "density.h5", "--quiet"], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL)
    with h5py.File(folder / "density.h5") as file:
        density, sigma = (file[name][:, columns // 2:] for name in ("density_kg_m3", "sigma_random_kg_m3"))
    return density - AMBIENT, sigma


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


def mirrored(derivative):
    return np.concatenate([-derivative[:0:-1], derivative])


def without_noise(program, folder):
    print("| radii | gladstone | PyAbel, three points |\n|---|---|---|")
    for n in (71, 141, 513):
        r, density, projection, derivative = exact(n)
        u = np.tile(-sensitivity() * mirrored(derivative), (20, 1))
        own, _ = invert(program, folder, u, np.full(u.shape, 0.01))
        peer = three_point_transform(projection, dr=r[1], direction="inverse")
        errors = [rms(found - density) / abs(AMPLITUDE) for found in (own[0], peer)]
        print(f"| {n} | {errors[0]:.1e} | {errors[1]:.1e} |", flush=True)


def with_noise(program, folder):
    print("\n| noise of the sides | gladstone | equal uncertainties | within one sigma | PyAbel, three points |\n"
          "|---|---|---|---|---|")
    n, rows = 141, 200
    r, density, _, derivative = exact(n)
    clean = -sensitivity() * mirrored(derivative)
    for ratio in (1, 4):
        sigma = 0.02 * np.abs(clean).max() * np.where(np.arange(2 * n - 1) < n, 1.0, ratio)
        u = clean + sigma * np.random.default_rng(1).standard_normal((rows, 2 * n - 1))
        sigma = np.broadcast_to(sigma, u.shape)
        weighted, stated = invert(program, folder, u, sigma)
        equal, _ = invert(program, folder, u, np.full(u.shape, sigma.mean()))
        folded = (u[:, n - 1:] - u[:, n - 1::-1]) / (-2 * sensitivity())
        steps = 0.5 * (folded[:, 1:] + folded[:, :-1]) * r[1]
        projection = np.concatenate([-np.cumsum(steps[:, ::-1], axis=1)[:, ::-1], np.zeros((rows, 1))], axis=1)
        peer = three_point_transform(projection, dr=r[1], direction="inverse")
        errors = [(found - density)[:, :-1] for found in (weighted, equal, peer)]
        cells = [f"{rms(error) / abs(AMPLITUDE):.4f}" for error in errors]
        within = np.mean(np.abs(errors[0]) <= stated[:, :-1])
        print(f"| 2 and {2 * ratio} % | {cells[0]} | {cells[1]} | {within:.3f} | {cells[2]} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gladstone")
    program = str(pathlib.Path(parser.parse_args().gladstone).resolve())
    print(f"PyAbel {version('PyAbel')}, numpy {np.__version__}\n")
    with tempfile.TemporaryDirectory() as temporary:
        without_noise(program, pathlib.Path(temporary))
        with_noise(program, pathlib.Path(temporary))


if __name__ == "__main__":
    main()
