"""dewarp.py GLADSTONE [--help]: which of `--dewarp vectors` and `--dewarp images` is more accurate?

Renders a laser sheet seen by two cameras at 30 and at 45 degrees from its normal, with uniform motion and with waves of
u, v and w (largest gradient 0.04 px per px), with and without noise. Both ways of dewarping reconstruct the same
images. Prints a table, and draws its figure to dewarp.png next to this file, or in FOLDER, if given.

Needs: pip install numpy h5py matplotlib
"""

import argparse
import math
import pathlib
import subprocess
import tempfile

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ANGLES = (30, 45)  # [deg] of either camera from the normal of the sheet
DISTANCE_MM, PIXEL_MM, DT_S = 750.0, 10e-3 * (750.0 - 105.0) / 105.0, 10e-6  # of an object of one pixel on the axis
F_NUMBER = 22.0  # the diameter of particle images is proportional to it
GROSS_PX = 1.0  # a vector with a larger error is a gross error
WAVE_PX, WAVELENGTH_PX = 1.5, 256.0
NOISE = {"no noise": "bit_depth = 12\n",
         "noise": "bit_depth = 12\nnoise.full_well_e = 120\nnoise.read_noise_e = 10.0\n"}
FLOWS = ("uniform", "gradients")
WAYS = ("vectors", "images")


def setup_text(degrees, flow, noise, seed, f_number=F_NUMBER):
    angle = math.radians(degrees)
    text = 'schema = 1\nexperiment = "piv"\n'
    for name, side in (("left", -1), ("right", 1)):
        place = [side * DISTANCE_MM * math.sin(angle), 0.0, DISTANCE_MM * math.cos(angle)]
        text += f'[[camera]]\nname = "{name}"\npixels = [256, 256]\npixel_pitch_um = 10.0\n'
        text += f'pose.position_mm = {place}\nsensor.scheimpflug = "auto"\n{NOISE[noise]}'
    velocity = [1e-3 * px * PIXEL_MM / DT_S for px in (2.3, -1.7, 1.9)]
    flow_text = f"velocity_m_s = {velocity}\ndt_us = {1e6 * DT_S}\n"
    if flow == "gradients":
        spacing = PIXEL_MM * WAVELENGTH_PX / 64
        flow_text += f'kind = "file"\nfile = "wave.npy"\nspacing_mm = {[spacing] * 3}\n'
        flow_text += "extrude = true\nperiodic = [true, true, false]\n"
    return text + f"""
[lens]
focal_length_mm = 105.0
f_number = {f_number}
[particles]
per_pixel = 0.04
scattering = "lambert"
seed = {seed}
[laser]
thickness_mm = 1.0
[flow]
{flow_text}
[correlate]
window_px = [64, 32, 32]
overlap = 0.5
uncertainty = "correlation_statistics"
"""


def write_wave(path):
    """One period of u = A sin ky, v = A sin kx, w = A sin(kx + ky) [m/s], as [y, x, component]."""
    phase = 2 * np.pi * np.arange(64) / 64
    x, y = np.meshgrid(phase, phase)
    amplitude = 1e-3 * WAVE_PX * PIXEL_MM / DT_S
    np.save(path, amplitude * np.stack([np.sin(y), np.sin(x), np.sin(x + y)], axis=-1))


def measure(program, folder, degrees, flow, noise, seed, f_number=F_NUMBER):
    """Returns the errors [px] and sigma [px] of u, v, w at the nodes that were accepted, for either way."""
    def run(*words):
        subprocess.run([program, *map(str, words), "--quiet", "--threads", "1"], cwd=folder, check=True,
                       capture_output=True)

    (folder / "setup.toml").write_text(setup_text(degrees, flow, noise, seed, f_number))
    run("render", "setup.toml", "-o", "case")
    for camera in ("left", "right"):
        run("correlate", f"case/{camera}")
    results = {}
    for way in WAYS:
        run("stereo", "case/left", "case/right", "-o", "uvw.h5", "--dewarp", way, "--no-figures")
        with h5py.File(folder / "uvw.h5") as file:
            pixel = float(file.attrs["pixel_size_mm"])
            status = file["status"][...].ravel()
            error = file["error_mm"][...].reshape(-1, 3) / pixel
            sigma = file["sigma_mm"][...].reshape(-1, 3) / pixel
        known = np.isfinite(error).all(axis=1)
        results[way] = (error[known], sigma[known], status[known] == 0)
    return results


def covered(error, sigma):
    """Fraction of the errors within sigma, for u, v and w; vectors without sigma, next to replaced ones, do not count."""
    known = np.isfinite(sigma).all(axis=1)
    return (np.abs(error[known]) <= sigma[known]).mean(axis=0)


def summarize(results):
    """Statistics over all seeds; the rms and the coverage are those of accepted vectors without gross errors."""
    error, sigma, accepted = (np.concatenate(parts) for parts in zip(*results))
    gross = np.abs(error).max(axis=1) > GROSS_PX
    good = accepted & ~gross
    return {"rms": np.sqrt((error[good] ** 2).mean(axis=0)), "bias": error[good].mean(axis=0),
            "coverage": covered(error[good], sigma[good]), "gross": gross.mean(),
            "gross accepted": (gross & accepted).sum() / accepted.sum(), "rejected": 1 - accepted.mean(),
            "count": len(error)}


def draw(table, path):
    cases = list(table)
    figure, axes = plt.subplots(2, 1, figsize=(9, 6.4), sharex=True, layout="constrained")
    colours, width = ("#1f77b4", "#2ca02c", "#d62728"), 0.13
    for place, case in enumerate(cases):
        for i, way in enumerate(WAYS):
            for k, name in enumerate("uvw"):
                at = place + (2 * k + i - 2.5) * width
                style = {"color": colours[k], "hatch": "///" if i else None, "edgecolor": "white", "linewidth": 0.5,
                         "label": f"{name}, --dewarp {way}" if place == 0 else None}
                axes[0].bar(at, table[case][way]["rms"][k], width, **style)
                axes[1].bar(at, 100 * table[case][way]["coverage"][k], width, **style)
    axes[0].set_yscale("log")
    axes[0].set_ylabel("rms error [px]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3, fontsize=8)
    axes[1].axhline(68.3, color="black", linewidth=1)
    axes[1].set_ylim(0, 100)
    axes[1].set_ylabel("errors within one sigma [%]")
    axes[1].set_xticks(range(len(cases)), [f"{a} degrees\n{flow}\n{noise}" for a, flow, noise in cases])
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--folder", type=pathlib.Path)
    parser.add_argument("--angles", type=int, nargs="+", default=ANGLES, help="[deg]")
    parser.add_argument("--f-number", type=float, default=F_NUMBER)
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    out = arguments.folder or pathlib.Path(__file__).parent
    table = {}
    print("| angle | flow | images | `--dewarp` | rms u | rms v | rms w | coverage u | v | w | gross | accepted | "
          "rejected |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        write_wave(folder / "wave.npy")
        for degrees in arguments.angles:
            for flow in FLOWS:
                for noise in NOISE:
                    runs = [measure(program, folder, degrees, flow, noise, seed, arguments.f_number)
                            for seed in range(1, arguments.seeds + 1)]
                    row = {way: summarize([run[way] for run in runs]) for way in WAYS}
                    table[degrees, flow, noise] = row
                    for way in WAYS:
                        s = row[way]
                        print(f"| {degrees} | {flow} | {noise} | {way} | "
                              + " | ".join(f"{value:.3f}" for value in s["rms"]) + " | "
                              + " | ".join(f"{100 * value:.0f} %" for value in s["coverage"])
                              + f" | {100 * s['gross']:.2f} % | {100 * s['gross accepted']:.2f} % | "
                              f"{100 * s['rejected']:.2f} % |", flush=True)
    draw(table, out / "dewarp.png")


if __name__ == "__main__":
    main()
