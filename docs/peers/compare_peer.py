"""Speed and error of another program and of gladstone, on images that gladstone renders. Imported by the scripts of
this folder, each of which measures one program and prints one table.

The images are cases of `gladstone benchmark`: 1024 x 1024 px, 8 bit, 20 particles of 3 px per 32 x 32 px (docs/
estimators.md). The programs take turns in every round on the first case, so that other load meets all of them; the best
round counts. The first round warms up just-in-time compilers and caches. Times are wall-clock times of measuring one
pair in memory: for gladstone `seconds_correlate` of --json, whose every run is a new process.

Errors are root mean squares per component against the exact displacement at the position of the vector, without those
above 1 px, in brackets the gain, and after a comma the fraction of vectors that are gross errors, missing or invalid:
`gladstone benchmark --vectors` scores all programs, its own included. With --keep FOLDER, images and vectors remain in
FOLDER; those of the first peer are in FOLDER/peer0, for `gladstone benchmark --vectors NAME=FOLDER/peer0`.
"""

import argparse
import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
import tifffile

CASES = ["uniform", "vortex", "sine_64", "noise_5"]
OWN = {
    "one pass, 32 px": ["correlate.window_px=[32]", "correlate.overlap=0.5", 'correlate.weighting="uniform"'],
    "default passes": ['correlate.uncertainty="none"'],
}


def timed(estimate):
    """Wraps a function that returns arrays x, y, u, v [px] as a function (a, b) -> (seconds, vectors)."""
    def measure(a, b):
        start = time.perf_counter()
        vectors = estimate(a, b)
        return time.perf_counter() - start, vectors
    return measure


def write_vectors(path, vectors):
    """Writes vectors as a CSV file of gladstone; NaN are invalid."""
    x, y, u, v = (np.asarray(one, float).ravel() for one in vectors)
    bad = ~(np.isfinite(u) & np.isfinite(v))
    rows = np.column_stack([x, y, u, v, u * np.nan, v * np.nan, u * np.nan, np.where(bad, 3, 0)])
    np.savetxt(path, rows, "%.17g", ",", header="x_px,y_px,u_px,v_px,sigma_u_px,sigma_v_px,peak_ratio,status",
               comments="")


class Gladstone:
    """Runs the program gladstone on the cases of a folder."""

    def __init__(self, program, folder, cases):
        self.program, self.folder, self.cases = program, folder, cases
        self.run("benchmark", "-o", folder, "--cases", *cases, "--estimators", "none", "--seeds", "0", "--no-figures")

    def run(self, *words, codes=(0,)):
        done = subprocess.run([self.program, *words, "--json", "--quiet", "--device", "cpu"], check=False,
                              capture_output=True, text=True)
        if done.returncode not in codes:
            raise RuntimeError(done.stderr or done.stdout)
        return json.loads(done.stdout)

    def frames(self, case):
        return [tifffile.imread(os.path.join(self.folder, case, name)) for name in ("reference.tif", "flow.tif")]

    def correlate(self, case, settings, threads, output):
        """Returns seconds and number of vectors."""
        images = [os.path.join(self.folder, case, name) for name in ("reference.tif", "flow.tif")]
        sets = [word for setting in settings for word in ("--set", setting)]
        result = self.run("correlate", *images, "-o", output, "--threads", str(threads), *sets)
        return result["seconds_correlate"], result["vectors"]

    def score(self, names):
        """Returns the text of each error by program and case. Prints likely mistakes in reading the vectors."""
        words = [f"{name}={os.path.join(self.folder, name)}" for name in names]
        result = self.run("benchmark", "-o", self.folder, "--cases", *self.cases, "--estimators", "none", "--seeds",
                          "0", "--no-figures", "--vectors", *words, codes=(0, 1))
        print(*result["likely_mistakes"], sep="\n", file=sys.stderr)
        cells = {}
        for row in result["scores"]:
            bad = 1 - row["valid_fraction"] * (1 - row["gross"] / max(row["count"], 1))
            text = f"{row['rms_without_gross_px']:.4f}"
            text += f" ({row['gain']:.3f})" if row["case"].startswith("sine") else ""
            cells[row["estimator"], row["case"]] = text + (f", {100 * bad:.2g} %" if bad > 0 else "")
        return cells


def compare(title, peers, describe):
    """Measures the peers of a script and gladstone, and prints the table.

    peers: by name, functions of two frames (uint8 [rows, columns]) that return seconds and the vectors x, y, u, v [px]:
        column and row from 0 at the centre of the first pixel, displacement to the right and downwards.
    describe: versions and backend of the program.
    """
    parser = argparse.ArgumentParser(description=title)
    parser.add_argument("gladstone", help="the program gladstone")
    parser.add_argument("--cases", nargs="+", default=CASES)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--keep", metavar="FOLDER", help="folder for images and vectors")
    arguments, _ = parser.parse_known_args()
    keep = arguments.keep and os.path.abspath(arguments.keep)
    with contextlib.nullcontext(keep) if keep else tempfile.TemporaryDirectory() as folder:
        own = Gladstone(os.path.abspath(arguments.gladstone), folder, arguments.cases)
        names = {f"own{i}": name for i, name in enumerate(OWN)} | {f"peer{i}": name for i, name in enumerate(peers)}
        for name in names:
            os.makedirs(os.path.join(folder, name), exist_ok=True)
        speed = {}
        for turn in range(arguments.rounds + 1):
            case = arguments.cases[0]
            frames = [frame.astype(np.uint8) for frame in own.frames(case)]
            for i, (name, settings) in enumerate(OWN.items()):
                for threads in (1, 2):
                    seconds, count = own.correlate(case, settings, threads, f"{folder}/own{i}/{case}.csv")
                    note_time(speed, f"gladstone, {name}, {threads} thread{'s' * (threads > 1)}", seconds, count, turn)
            for i, (name, measure) in enumerate(peers.items()):
                seconds, vectors = measure(*frames)
                write_vectors(f"{folder}/peer{i}/{case}.csv", vectors)
                note_time(speed, name, seconds, np.size(vectors[2]), turn)
        for case in arguments.cases[1:]:
            frames = [frame.astype(np.uint8) for frame in own.frames(case)]
            for i, settings in enumerate(OWN.values()):
                own.correlate(case, settings, 2, f"{folder}/own{i}/{case}.csv")
            for i, measure in enumerate(peers.values()):
                write_vectors(f"{folder}/peer{i}/{case}.csv", measure(*frames)[1])
        cells = own.score(names)
    print(f"{describe}; numpy {np.__version__}; best of {arguments.rounds} in turns, {os.cpu_count()} cores, load "
          f"{os.getloadavg()[0]:.1f}\n")
    print("| | time | vectors/s | " + " | ".join(arguments.cases) + " |")
    print("|---" * (3 + len(arguments.cases)) + "|")
    for name, (seconds, count) in speed.items():
        key = next(key for key, known in names.items() if known == name or name.startswith(f"gladstone, {known},"))
        errors = [cells.get((key, case), "-") for case in arguments.cases]
        print(f"| {name} | {1e3 * seconds:.1f} ms | {count / seconds:,.0f} | " + " | ".join(errors) + " |")


def note_time(speed, name, seconds, count, turn):
    """Stores the shortest time of a program; the first round is ignored."""
    if turn > 0:
        speed[name] = min(speed.get(name, (float("inf"), count)), (seconds, count))
