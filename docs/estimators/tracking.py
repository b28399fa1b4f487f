"""tracking.py GLADSTONE [--rows NAME ..] [--threads N] [--frames | --flows]: is the uncertainty of tracked dots valid?

Tracks equal Gaussian particles of 3 px (20 per 32 x 32 px, 256 x 256 px) displaced by (2.3, -1.7) px, and the dots and
particles of two rendered cases. Prints, for each row of the table in docs/estimators.md, the fraction of dots that are
missed or have errors above 1 px (5 px at the border excluded), the fractions of errors within one and two standard
uncertainties, rms(sigma) over rms(error), and the rms error.

With --frames: what do the frames before and after a pair contribute? Tracks particles (7 px apart) of a vortex whose
velocity differs by up to 30 % through the depth of the light sheet, in a pair and in a sequence of four frames. Prints,
over the ratio of the largest displacement and the spacing, the fraction of the vectors on the grid that are valid, and
the rms error of these against the mean over the depth.

With --flows: which errors do correlation and tracking have? Prints the rms error per component of the default
correlation and of tracking, on the grid and scattered, at the vectors; vectors that are missing or have errors above
1 px are counted apart. Particles of a flow move by half of the displacement before and after their place.

Needs: pip install numpy scipy h5py imageio
"""

import argparse
import pathlib
import subprocess
import tempfile

import h5py
import imageio.v3
import numpy as np
from scipy.spatial import cKDTree
from scipy.special import erf

SIDE, COUNT, SIGMA_PX = 256, 1280, 0.75  # [px], dots, standard deviation of a dot of 3 px (e^-2)
MOVED_PX = np.array([2.3, -1.7])
BORDER_PX, GROSS_PX = 5, 1.0
SPACING_PX = 7.0  # mean spacing of the particles with --frames
CASES = pathlib.Path(__file__).resolve().parents[2] / "studies" / "cases"
TRACKING = '[correlate]\nmethod = "tracking"\n[correlate.tracking]\noutput = "scattered"\n'
NOISE = ["--set", "camera.noise.full_well_e=30000"]
SYNTHETIC = {"8 bit, no noise": (8, 0.0), "8 bit, 1 % noise": (8, 0.01), "8 bit, 5 % noise": (8, 0.05),
             "16 bit, no noise": (16, 0.0)}
RENDERED = {"piv.toml, no noise": ("piv.toml", ["--set", f"camera.pixels=[{SIDE}, {SIDE}]"]),
            "piv.toml, noise": ("piv.toml", ["--set", f"camera.pixels=[{SIDE}, {SIDE}]", *NOISE]),
            "bench.toml, no noise": ("bench.toml", []),
            "bench.toml, 5 dots, noise": ("bench.toml", ["--set", "target.dots_per_32px_window=5", *NOISE])}


def image(places, bits, noise, random):
    """Gaussian particles integrated over the pixels, of 40 % of full scale, so that few overlaps saturate."""
    pixel = np.arange(SIDE)
    def share(at):
        scale = np.sqrt(0.5) / SIGMA_PX
        t = pixel - at[:, None]
        return SIGMA_PX * np.sqrt(np.pi / 2) * (erf((t + 0.5) * scale) - erf((t - 0.5) * scale))
    full = 2**bits - 1
    peak = 0.4 * full
    level = peak * (share(places[:, 1]).T @ share(places[:, 0]) + 0.06 + 5 * noise)
    level += noise * peak * random.standard_normal(level.shape)
    return np.clip(np.rint(level), 0, full).astype(np.uint8 if bits == 8 else np.uint16)


def make_pair(folder, bits, noise, seed):
    """Writes a.tif and b.tif. @return positions midway between both frames, and displacements [px]"""
    random = np.random.default_rng(seed)
    middle = random.random((COUNT, 2)) * SIDE - 0.5
    imageio.v3.imwrite(folder / "a.tif", image(middle - MOVED_PX / 2, bits, noise, random))
    imageio.v3.imwrite(folder / "b.tif", image(middle + MOVED_PX / 2, bits, noise, random))
    return middle, np.broadcast_to(MOVED_PX, middle.shape)


def read_truth(case):
    with h5py.File(case / "truth.h5") as file:
        group = file["dots" if "dots" in file else "particles"]
        displacement = group["displacement_px"][...]
        middle = group["reference_px"][...] + displacement / 2
    known = np.isfinite(middle).all(axis=1)
    return middle[known], displacement[known]


def evaluate(vectors, middle, displacement):
    """Returns statistics of the vectors; each vector is assigned to the nearest dot within 1 px."""
    with h5py.File(vectors) as file:
        at, measured, sigma = (np.stack([file[a][...], file[b][...]], axis=-1) for a, b in
                               (("x_px", "y_px"), ("u_px", "v_px"), ("sigma_u_px", "sigma_v_px")))
    valid = np.isfinite(measured).all(axis=1) & np.isfinite(sigma).all(axis=1)
    distance, own = cKDTree(middle).query(at[valid])
    error = measured[valid] - displacement[own]
    good = (distance < 1) & (np.abs(error).max(axis=1) < GROSS_PX)
    inside = (np.abs(middle - (SIDE - 1) / 2) < SIDE / 2 - BORDER_PX).all(axis=1)
    found = np.zeros(len(middle), dtype=bool)
    found[own[good]] = True
    error, sigma = error[good], sigma[valid][good]
    ratio = np.abs(error / sigma)
    return {"missed": 1 - found[inside].mean(), "one": (ratio <= 1).mean(), "two": (ratio <= 2).mean(),
            "sigma": np.sqrt((sigma**2).mean() / (error**2).mean()), "rms": np.sqrt((error**2).mean()),
            "count": error.size}


def vortex(places, time):
    """Returns the position of each particle after a time [intervals], for a largest velocity of 1 px per interval."""
    radius = places - SIDE / 2
    core = 8 * SPACING_PX
    angle = 2 / core / (1 + (radius**2).sum(axis=1) / core**2) * time
    turned = np.stack([np.cos(angle) * radius[:, 0] - np.sin(angle) * radius[:, 1],
                       np.sin(angle) * radius[:, 0] + np.cos(angle) * radius[:, 1]], axis=1)
    return SIDE / 2 + turned


def evaluate_grid(vectors, ratio):
    """Returns the fraction of valid vectors, and the rms error of their displacements per component [px]."""
    with h5py.File(vectors) as file:
        at, measured = (np.stack([file[a][...], file[b][...]], axis=-1) for a, b in
                        (("x_px", "y_px"), ("u_px", "v_px")))
    half = np.full(len(at), 0.5 * ratio * SPACING_PX)
    valid = np.isfinite(measured).all(axis=1)
    error = (measured - vortex(at, half) + vortex(at, -half))[valid]
    return valid.mean(), np.sqrt((error**2).mean())


def compare_frames(run, seed):
    """Prints the table of --frames."""
    print("| displacement / spacing | valid, two frames | rms error [px] | valid, four frames | rms error [px] |\n"
          "|---|---|---|---|---|")
    for ratio in (0.2, 0.5, 1.0, 1.5, 2.0):
        random = np.random.default_rng(seed)
        start = random.random((int((SIDE / SPACING_PX)**2), 2)) * SIDE
        speed = ratio * SPACING_PX * (1 + 0.3 * (2 * random.random(len(start)) - 1))
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            for k in range(4):
                imageio.v3.imwrite(folder / f"img_{k}.tif", image(vortex(start, (k - 1) * speed), 8, 0.01, random))
            settings = ["--set", "correlate.method=tracking"]
            run("correlate", folder / "img_1.tif", folder / "img_2.tif", "-o", folder / "v.h5", *settings)
            run("correlate", folder / "img_*.tif", "-o", folder / "four/", "--pairing", "consecutive", *settings)
            two, four = (evaluate_grid(folder / name, ratio) for name in ("v.h5", "four/img_1.h5"))
        print(f"| {ratio} | {two[0]:.2f} | {two[1]:.2f} | {four[0]:.2f} | {four[1]:.2f} |", flush=True)


FLOWS = {  # displacement [px] at places [n, 2], and relative noise
    "uniform": (lambda p: np.broadcast_to(MOVED_PX, p.shape), 0.0),
    "uniform, 1 % noise": (lambda p: np.broadcast_to(MOVED_PX, p.shape), 0.01),
    "uniform, 5 % noise": (lambda p: np.broadcast_to(MOVED_PX, p.shape), 0.05),
    "u = 2 sin(2 pi y / 64 px)": (lambda p: np.stack([2 * np.sin(2 * np.pi * p[:, 1] / 64), 0 * p[:, 0]], 1), 0.0),
    "u = 2 sin(2 pi y / 32 px)": (lambda p: np.stack([2 * np.sin(2 * np.pi * p[:, 1] / 32), 0 * p[:, 0]], 1), 0.0),
    "u = -3 tanh(x / 6 px)": (lambda p: np.stack([-3 * np.tanh((p[:, 0] - SIDE / 2) / 6), 0 * p[:, 0]], 1), 0.0)}


def compare_flows(run, seed):
    """Prints the table of --flows."""
    ways = {"default correlation": [], "tracking, grid": ["correlate.method=tracking"],
            "tracking, scattered": ["correlate.method=tracking", "correlate.tracking.output=scattered"]}
    print("| flow |" + "".join(f" {way} |" for way in ways) + "\n|---|" + "---|" * len(ways))
    for flow, (displacement, noise) in FLOWS.items():
        random = np.random.default_rng(seed)
        middle = random.random((COUNT, 2)) * SIDE - 0.5
        half = displacement(middle) / 2
        cells = []
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            for name, places in (("a.tif", middle - half), ("b.tif", middle + half)):
                imageio.v3.imwrite(folder / name, image(places, 8, noise, random))
            for words in ways.values():
                settings = [word for setting in words for word in ("--set", setting)]
                run("correlate", folder / "a.tif", folder / "b.tif", "-o", folder / "v.h5", *settings)
                with h5py.File(folder / "v.h5") as file:
                    at, measured = (np.stack([file[a][...], file[b][...]], axis=-1) for a, b in
                                    (("x_px", "y_px"), ("u_px", "v_px")))
                inside = ((at > 2 * BORDER_PX) & (at < SIDE - 2 * BORDER_PX)).all(axis=1)
                error = (measured - displacement(at))[inside]
                good = (np.abs(error) < GROSS_PX).all(axis=1)
                cells.append(f" {np.sqrt((error[good]**2).mean()):.4f}" +
                             (f", {100 * (1 - good.mean()):.1f} %" if good.mean() < 0.9995 else "") + " |")
        print(f"| {flow} |" + "".join(cells), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--rows", nargs="+", choices=[*SYNTHETIC, *RENDERED], default=[*SYNTHETIC, *RENDERED])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1, help="of the synthetic images")
    parser.add_argument("--flows", action="store_true", help="compare correlation and tracking instead")
    parser.add_argument("--frames", action="store_true", help="compare two with four frames instead")
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())

    def run(*words):
        subprocess.run([program, *map(str, words), "--quiet", "--threads", str(arguments.threads)], check=True,
                       capture_output=True)

    if arguments.frames:
        compare_frames(run, arguments.seed)
        return
    if arguments.flows:
        compare_flows(run, arguments.seed)
        return
    print("| images | missed | within one | within two | rms(sigma) / rms(error) | rms error [px] | components |\n"
          "|---|---|---|---|---|---|---|")
    for row in arguments.rows:
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            (folder / "tracking.toml").write_text(TRACKING)
            if row in SYNTHETIC:
                truth = make_pair(folder, *SYNTHETIC[row], arguments.seed)
                inputs = [folder / "a.tif", folder / "b.tif"]
            else:
                setup, words = RENDERED[row]
                run("render", CASES / setup, "-o", folder / "case", *words)
                truth = read_truth(folder / "case")
                inputs = [folder / "case"]
            run("correlate", *inputs, "-o", folder / "v.h5", "--config", folder / "tracking.toml")
            s = evaluate(folder / "v.h5", *truth)
        print(f"| {row} | {100 * s['missed']:.1f} % | {s['one']:.2f} | {s['two']:.2f} | {s['sigma']:.2f} | "
              f"{s['rms']:.4f} | {s['count']} |", flush=True)


if __name__ == "__main__":
    main()
