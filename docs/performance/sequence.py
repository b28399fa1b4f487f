"""sequence.py GLADSTONE [--pairs N] [--distinct D] [--threads N] [--folder DIR] [--seed S]: how fast are sequences?

Draws D distinct pairs of particle images of 1024 x 1024 px, 16 bit (Gaussian particles of 3 px, 20 per 32 x 32 px,
displaced by up to 3 px in sines of 256 px), and links them as a sequence of N pairs. Then:

1. correlates N / 10 and N pairs, and prints wall time, processor time (user + system) and the largest memory;
2. correlates the N pairs again, kills the program (SIGKILL) at a random moment, repeats the command, and checks that
   every pair is there and equal to that of the run that was not killed, and so are the statistics.

The frames are in the page cache, unless memory is short. Exit code 1 if a check fails.

Needs: pip install numpy scipy h5py imageio
"""

import argparse
import json
import os
import pathlib
import platform
import random
import subprocess
import sys
import tempfile
import time

import h5py
import imageio.v3
import numpy as np
from scipy.special import erf

SIDE, COUNT, SIGMA_PX = 1024, 20480, 0.75  # [px], particles, standard deviation of a particle of 3 px (e^-2)
REACH_PX = 5
LEVEL, NOISE, PEAK = 1000, 100, 20000  # [grey levels]


def draw(places, noise):
    """Gaussian particles integrated over the pixels."""
    image = LEVEL + NOISE * noise.standard_normal((SIDE, SIDE))
    offsets = np.arange(-REACH_PX, REACH_PX + 1)
    pixel = np.rint(places).astype(int)[:, None, :] + offsets[:, None]  # [particle, offset, axis]
    scale = np.sqrt(0.5) / SIGMA_PX
    t = (pixel - places[:, None, :]) * scale
    share = SIGMA_PX * np.sqrt(np.pi / 2) * (erf(t + 0.5 * scale) - erf(t - 0.5 * scale))
    stamps = PEAK * share[:, :, None, 1] * share[:, None, :, 0]
    rows, columns = np.broadcast_arrays(pixel[:, :, None, 1], pixel[:, None, :, 0])
    inside = (rows >= 0) & (rows < SIDE) & (columns >= 0) & (columns < SIDE)
    np.add.at(image, (rows[inside], columns[inside]), stamps[inside])
    return np.clip(np.rint(image), 0, 65535).astype(np.uint16)


def make_frames(folder, pairs, distinct, seed):
    """Writes A_0000.tif, B_0000.tif, ... of which `distinct` pairs are different."""
    for k in range(pairs):
        names = [folder / f"{frame}_{k:04}.tif" for frame in "AB"]
        if k >= distinct:
            for name in names:
                os.link(folder / f"{name.name[0]}_{k % distinct:04}.tif", name)
            continue
        noise = np.random.default_rng((seed, k))
        middle = noise.random((COUNT, 2)) * (SIDE + 20) - 10
        phase = 2 * np.pi * (middle[:, ::-1] / 256 + noise.random(2))
        half = 1.5 * np.sin(phase)
        imageio.v3.imwrite(names[0], draw(middle - half, noise))
        imageio.v3.imwrite(names[1], draw(middle + half, noise))


def run(words):
    """Runs a command. @return wall time, processor time [s], largest resident memory [MB]"""
    start = time.monotonic()
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    message = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{words}: exit code {process.returncode}\n{message.decode()}")
    return time.monotonic() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def kill_at(words, folder, pairs):
    """Starts a command and kills it after a number of pairs. @return number of pairs that are stored at that time"""
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while len(list(folder.glob("A_*.h5"))) < pairs and process.poll() is None:
        time.sleep(0.02)
    process.kill()
    process.wait()
    return len(list(folder.glob("A_*.h5")))


def equal(a, b):
    """Returns True if all datasets of two files are equal, bit by bit."""
    def datasets(file):
        found = {}
        file.visititems(lambda name, item: found.update({name: item[...].tobytes()})
                        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu" else None)
        return found
    with h5py.File(a) as one, h5py.File(b) as other:
        return datasets(one) == datasets(other)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--pairs", type=int, default=1000)
    parser.add_argument("--distinct", type=int, default=20)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--device", default="auto")
    parser.add_argument("--folder", help="for the images and results, default: a temporary folder")
    parser.add_argument("--seed", type=int, default=None, help="of the moment of the kill; default: another every time")
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    seed = arguments.seed if arguments.seed is not None else random.SystemRandom().randrange(10**6)
    pairs = arguments.pairs
    with tempfile.TemporaryDirectory(dir=arguments.folder) as temporary:
        folder = pathlib.Path(temporary)
        frames = folder / "frames"
        frames.mkdir()
        make_frames(frames, pairs, min(arguments.distinct, pairs), 1)

        def command(output, count=pairs):
            files = [str(frames / f"{frame}_{k:04}.tif") for frame in "AB" for k in range(count)]
            return [program, "correlate", *files, "-o", f"{output}/", "--quiet", "--threads", str(arguments.threads),
                    "--device", arguments.device]

        print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} processors, {arguments.threads} threads")
        print("| pairs | wall time [s] | pairs per second | processor time per pair [s] | largest memory [MB] |\n"
              "|---|---|---|---|---|")
        for count in sorted({max(2, pairs // 10), pairs}):
            wall, processor, memory = run(command(folder / f"whole{count}", count))
            print(f"| {count} | {wall:.1f} | {count / wall:.2f} | {processor / count:.3f} | {memory:.0f} |", flush=True)
        whole, resumed = folder / f"whole{pairs}", folder / "resumed"
        stored = kill_at(command(resumed), resumed, random.Random(seed).randrange(1, max(2, pairs - 5)))
        run(command(resumed))
        state = json.loads((resumed / "sequence.json").read_text())
        done = [pair["vectors"] for pair in state["pairs"] if pair["state"] == "done"]
        same = [name for name in done if equal(whole / name, resumed / name)]
        statistics = equal(whole / "statistics.h5", resumed / "statistics.h5")
        print(f"killed with {stored} pairs stored (seed {seed}); after the same command {len(done)} of {pairs} pairs, "
              f"{len(same)} equal to those of the other run, statistics {'equal' if statistics else 'different'}")
        left_over = [name for name in os.listdir(resumed) if not name.endswith((".h5", ".json", ".png"))]
        if left_over:
            print("files left by the kill:", left_over)
        if not (state["complete"] and len(done) == len(same) == pairs and statistics and not left_over):
            sys.exit(1)


if __name__ == "__main__":
    main()
