"""coverage.py GLADSTONE [--seeds 2]: which fraction of the errors of u, v and w is within one standard uncertainty?

Renders the laser sheet of dewarp.py with uniform motion, seen at 30 and at 45 degrees from its normal: without noise
(12 bits), and with the noise of an ordinary camera (full well of 30000 electrons, read noise of 3, a black level of 16)
at 8 and at 12 bits. Prints a table for both ways of `--dewarp`, with the ideal fraction of 68 %.

Needs: pip install numpy h5py matplotlib
"""

import argparse
import pathlib
import tempfile

import dewarp

CAMERA = "offset_dn = 16\nnoise.full_well_e = 30000\nnoise.read_noise_e = 3.0\n"
NOISE = {"12 bit, no noise": "bit_depth = 12\n", "12 bit, noise": "bit_depth = 12\n" + CAMERA,
         "8 bit, noise": "bit_depth = 8\n" + CAMERA}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=2)
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    dewarp.NOISE.update(NOISE)
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
