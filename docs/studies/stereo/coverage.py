"""coverage.py GLADSTONE [--cameras]: which fraction of the errors of u, v and w is within one standard uncertainty?

Renders the laser sheet of dewarp.py with uniform motion, seen at 30 and at 45 degrees from its normal: without noise
(12 bits), and with the noise of an ordinary camera (full well of 30000 electrons, read noise of 3, a black level of 16)
at 8 and at 12 bits. Prints a table for both ways of `--dewarp`; the ideal fraction is 68 %.

--cameras prints the same for the vectors of the left camera without noise, by several methods of uncertainty, for a
sheet of 1 mm with and without motion through it (w), and for a thick sheet. Their sigma, which the components inherit,
is too large if the particles change their brightness.

Needs: pip install numpy h5py matplotlib
"""

import argparse
import json
import pathlib
import re
import subprocess
import tempfile

import dewarp
import numpy as np

CAMERA = "offset_dn = 16\nnoise.full_well_e = 30000\nnoise.read_noise_e = 3.0\n"
NOISE = {"12 bit, no noise": "bit_depth = 12\n", "12 bit, noise": "bit_depth = 12\n" + CAMERA,
         "8 bit, noise": "bit_depth = 8\n" + CAMERA}


METHODS = ("correlation_statistics", "image_matching", "combination")
SHEETS = ((1.0, (2.3, -1.7, 1.9)), (1.0, (0.0, 0.0, 1.9)), (1.0, (2.3, -1.7, 0.0)), (4.0, (2.3, -1.7, 1.9)))


def measure_camera(program, folder, degrees, sheet_mm, velocity_px, seed):
    """Rms error [px] of the vectors of the left camera without noise, then coverage and rms(sigma)/rms(error) of each
    method. The number of particles per pixel does not depend on the thickness of the sheet."""
    def run(*words):
        subprocess.run([program, *words, "--quiet", "--threads", "1"], cwd=folder, check=True, capture_output=True)

    velocity = [1e-3 * px * dewarp.PIXEL_MM / dewarp.DT_S for px in velocity_px]
    text = dewarp.setup_text(degrees, "uniform", "12 bit, no noise", seed)
    text = re.sub(r"velocity_m_s = .*", f"velocity_m_s = {velocity}", text)
    (folder / "setup.toml").write_text(re.sub(r"thickness_mm = .*", f"thickness_mm = {sheet_mm}", text))
    run("render", "setup.toml", "-o", "case")
    result = []
    for method in METHODS:
        run("correlate", "case/left", "--set", f"correlate.uncertainty={method}")
        run("compare", "case/left", "--no-figures")
        errors = json.loads((folder / "case/left/errors.json").read_text())
        check = errors["uncertainty"]["deformed_window_truth"]
        result = [errors["ray_truth"]["rms_px"], *result[1:], check["coverage_1"], check["rms_ratio"]]
    return result


def print_cameras(program, folder, seeds):
    print("| angle | sheet | u, v, w [px] | rms error [px] | " + " | ".join(METHODS) + " |\n" + "|---" * 7 + "|")
    for degrees in dewarp.ANGLES:
        for sheet, velocity in SHEETS:
            error, *checks = np.mean([measure_camera(program, folder, degrees, sheet, velocity, seed)
                                      for seed in range(1, seeds + 1)], axis=0)
            cells = [f"{100 * coverage:.0f} %, {ratio:.2f}" for coverage, ratio in zip(checks[::2], checks[1::2])]
            print(f"| {degrees} deg | {sheet:g} mm | {', '.join(f'{px:g}' for px in velocity)} | {error:.4f} | "
                  + " | ".join(cells) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--cameras", action="store_true")
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    dewarp.NOISE.update(NOISE)
    if arguments.cameras:
        with tempfile.TemporaryDirectory() as temporary:
            return print_cameras(program, pathlib.Path(temporary), arguments.seeds)
    print("| angle | images | `--dewarp` | coverage u | v | w | rms u | v | w [px] | vectors |\n"
          "|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as temporary:
        for degrees in dewarp.ANGLES:
            for noise in NOISE:
                runs = [dewarp.measure(program, pathlib.Path(temporary), degrees, "uniform", noise, seed)
                        for seed in range(1, arguments.seeds + 1)]
                for way in dewarp.WAYS:
                    s = dewarp.summarize([run[way] for run in runs])
                    print(f"| {degrees} deg | {noise} | `{way}` | "
                          + " | ".join(f"{100 * value:.0f} %" for value in s["coverage"]) + " | "
                          + " | ".join(f"{value:.3f}" for value in s["rms"]) + f" | {s['count']} |", flush=True)


if __name__ == "__main__":
    main()
