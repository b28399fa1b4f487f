"""openpiv.py GLADSTONE [--size 1024] [--rounds 15]: speed and error of OpenPIV's two backends and of gladstone on one pair.

One pass of uniform 32 x 32 px windows at overlap 0.5, three-point Gaussian fit, peak ratio and median test. The pair is
drawn here: integrated Gaussian particles of 3 px (e^-2), 20 in a window, 8 bit, without noise, displaced by
(2.3, -1.7) px. The programs take turns in every round, so that other load meets all of them; the best round counts.

Wall-clock time is that of correlation and validation: in this process for OpenPIV, after a first round that warms it up,
and by --json's seconds_correlate for gladstone, whose every run starts cold. Processor time is this process's for OpenPIV;
for gladstone at most wall-clock time times threads, which is what is printed.

Needs: pip install 'openpiv[rust]==0.26.1' numpy==2.4.6 tifffile==2026.3.3
"""
import sys

sys.path.pop(0)  # this folder, where openpiv.py would be taken for the package

import argparse
import json
import math
import os
import subprocess
import tempfile
import time
from importlib.metadata import version

import numpy as np
import tifffile
from openpiv import pyprocess, validation

SHIFT = np.array([2.3, -1.7])
WINDOW, OVERLAP = 32, 16


def draw(size, positions, diameter=3.0):
    """Grey levels of particles of `diameter` px, integrated over the pixels."""
    sigma = diameter / 4.0
    image = np.zeros((size + 16, size + 16))
    erf = np.vectorize(math.erf)
    reach = np.arange(-6, 7)
    cells = np.round(positions).astype(int)
    offset = (positions - cells).T  # of either coordinate from its pixel's centre
    edges = reach[None, None, :, None] + np.array([-0.5, 0.5]) - offset[:, :, None, None]
    parts = erf(edges / (math.sqrt(2.0) * sigma))
    along = 0.5 * (parts[..., 1] - parts[..., 0])
    for (column, row), x, y in zip(cells + 8, along[0], along[1]):
        if 6 <= column < size + 10 and 6 <= row < size + 10:
            image[row - 6:row + 7, column - 6:column + 7] += np.outer(y, x)
    return image[8:-8, 8:-8]


def make_pair(size):
    random = np.random.default_rng(1)
    count = round(20 * (size + 16) ** 2 / WINDOW**2)
    middle = random.uniform(-8, size + 8, (count, 2))
    pair = [draw(size, middle + side * SHIFT) for side in (-0.5, 0.5)]
    scale = 200.0 / max(np.quantile(frame, 0.999) for frame in pair)
    return [np.clip(np.round(scale * frame), 0, 255).astype(np.uint8) for frame in pair]


def report_error(u, v):
    error = np.array([u, v]).reshape(2, -1) - SHIFT[:, None]
    error = error[:, np.all(np.isfinite(error), axis=0)]
    rms = np.sqrt(np.mean(error**2, axis=1))
    return f"{rms[0]:.4f}, {rms[1]:.4f}", f"{np.mean(error[0]):+.4f}"


def run_openpiv(a, b, backend):
    wall, cpu = time.perf_counter(), time.process_time()
    u, v, ratio = pyprocess.extended_search_area_piv(
        a, b, window_size=WINDOW, overlap=OVERLAP, search_area_size=WINDOW, correlation_method="circular",
        subpixel_method="gaussian", sig2noise_method="peak2peak",
        backend=backend)
    bad = validation.sig2noise_val(ratio, threshold=1.0) | validation.local_median_val(u, v, 2.0, 2.0)
    seconds = time.perf_counter() - wall, time.process_time() - cpu
    u[bad] = np.nan
    return u.size, seconds, report_error(u, v)  # rows count downwards until transform_coordinates


def run_gladstone(program, folder, threads):
    vectors = os.path.join(folder, "v.csv")
    command = [program, "correlate", folder + "/a.tif", folder + "/b.tif", "-o", vectors, "--json", "--quiet",
               "--device", "cpu", "--threads", str(threads), "--set", f"correlate.window_px=[{WINDOW}]",
               "--set", "correlate.overlap=0.5", "--set", 'correlate.weighting="uniform"']
    result = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    table = np.genfromtxt(vectors, delimiter=",", names=True)
    good = table["status"] == 0
    seconds = result["seconds_correlate"]
    errors = report_error(table["u_px"][good], table["v_px"][good])
    return result["vectors"], (seconds, threads * seconds), errors


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("gladstone")
    arguments.add_argument("--size", type=int, default=1024)
    arguments.add_argument("--rounds", type=int, default=15)
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        a, b = make_pair(given.size)
        tifffile.imwrite(folder + "/a.tif", a)
        tifffile.imwrite(folder + "/b.tif", b)
        runs = {f"gladstone, {n} thread{'s' * (n > 1)}": lambda n=n: run_gladstone(given.gladstone, folder, n)
                for n in (1, 2)}
        for backend in ("rust", "scipy"):
            runs[f"OpenPIV, {backend} backend"] = lambda s=backend: run_openpiv(a.astype(np.int32), b.astype(np.int32), s)
        results = {name: [] for name in runs}
        for _ in range(given.rounds):
            for name, run in runs.items():
                results[name].append(run())
    print(f"OpenPIV {version('openpiv')}, openpiv_rust {version('openpiv_rust')}, numpy {version('numpy')}; "
          f"{given.size} x {given.size} px, best of {given.rounds} in turns, {os.cpu_count()} cores, load "
          f"{os.getloadavg()[0]:.1f}\n")
    print("| | wall-clock | vectors/s | processor time | vectors per s of it | rms error of u, v [px] | mean of u [px] |")
    print("|---|---|---|---|---|---|---|")
    for name, rounds in results.items():
        count = rounds[0][0]
        wall, cpu = (min(r[1][i] for r in rounds) for i in (0, 1))
        rms, mean = rounds[0][2]
        print(f"| {name} | {1e3 * wall:.1f} ms | {count / wall:,.0f} | {1e3 * cpu:.1f} ms | {count / cpu:,.0f} "
              f"| {rms} | {mean} |")


main()
