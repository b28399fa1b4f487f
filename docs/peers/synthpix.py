"""synthpix.py [--bench BENCH] [--rounds 20] [--cpu]: pairs per second of SynthPix and of gladstone on one GPU.

SynthPix draws pairs of Gaussian particle images of 256, 512 and 1024 px: 0.05 particles per pixel, 3.3 px wide (e^-2), no
noise, no hidden particles. gladstone's `pair_batches` draws the same number of particles of the same size, as illuminated
by a Gaussian sheet and seen through a lens (tests/benchmarks/cuda/pair_batches_bench.cpp). Both leave the images on the
GPU, and both are measured with the same batch sizes. Batches are warmed up; the median of the rounds counts.

There are two comparisons. "one flow": all pairs have the same flow. "own flow": every pair has its own. SynthPix (0.3.1,
data_generate.py) is given the flow as an array of displacements at every pixel, from which it moves the particles: this
array is the truth, exists before the loop and takes no time in it. gladstone is given formulas and computes the
displacement of every pixel of every pair within the timed loop of "own flow".

In SynthPix 0.3.1 (generate.py), diameters are standard deviations times 2, hence 1.65 here, and a particle is drawn on
5 x 5 px, sampled at their centres; gladstone integrates over 11 x 11 px.

Needs a GPU, pip install synthpix==0.3.1 'jax[cuda12]', and for gladstone BENCH = build/cuda/bin/gladstone_cuda_bench.
Without a GPU, JAX would use the CPU; --cpu permits this.
"""
import sys

sys.path.pop(0)  # this folder, where synthpix.py would be taken for the package

import argparse
import datetime
import json
import pathlib
import re
import statistics
import subprocess
import time
from importlib.metadata import version

import jax
import jax.numpy as jnp
from synthpix.data_generate import generate_images_from_flow
from synthpix.types import ImageGenerationSpecification

BATCHES = {256: (64, 1024), 512: (64, 256), 1024: (8, 64)}  # of pair_batches_bench.cpp


def synthpix_rate(side, batch, flows, rounds):
    """Returns the pairs per second. flows: number of different flows among the pairs."""
    specification = ImageGenerationSpecification(
        batch_size=batch, image_shape=(side, side), img_offset=(16, 16), seeding_density_range=(0.05, 0.05),
        p_hide_img1=0.0, p_hide_img2=0.0, diameter_ranges=[(1.65, 1.65)], diameter_var=0.0,
        intensity_ranges=[(200, 200)], intensity_var=0.0, rho_ranges=[(0.0, 0.0)], rho_var=0.0, dt=1.0,
    )  # fmt: skip
    bounds = (side + 32, side + 32)
    x = jnp.linspace(0, 6.283, bounds[0])
    flow = 3 * jnp.stack([jnp.sin(x)[None, :] * jnp.cos(x)[:, None], -jnp.cos(x)[None, :] * jnp.sin(x)[:, None]], -1)
    flow = flow * jnp.linspace(1, 0.5, flows)[:, None, None, None]
    draw = jax.jit(lambda key, flow: generate_images_from_flow(key, flow, specification, position_bounds=bounds)[:2])
    seconds = []
    for k in range(rounds + 2):
        start = time.perf_counter()
        jax.block_until_ready(draw(jax.random.PRNGKey(k), flow))
        seconds.append(time.perf_counter() - start)
    return batch / statistics.median(seconds[2:])


def gladstone_rates(bench):
    """Returns the pairs per second by side, batch and whether every pair has its own flow."""
    command = [bench, "--benchmark_filter=pair_batches.*noise:0", "--benchmark_format=json"]
    result = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    rates = {}
    for run in result["benchmarks"]:
        if run.get("error_occurred"):
            sys.exit(f"{run['name']}: {run['error_message']}")
        given = {key: int(value) for key, value in re.findall(r"(\w+):(\d+)", run["name"])}
        rates[given["side"], given["pairs"], given["own_setup"] == 1] = run["pairs/s"]
    return rates


def first_line(*command):
    """Returns the first line that a program prints; "unknown" without the program."""
    try:
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()[0]
    except (OSError, subprocess.CalledProcessError, IndexError):
        return "unknown"


def report(side, own, batch, rates):
    """Prints the rates of SynthPix and gladstone; "-": not measured."""
    texts = (f"{rate:.0f}" if rate else "-" for rate in rates)
    print(f"{side}, {'own' if own else 'one'} flow, {batch}:", ", ".join(texts), flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bench")
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--cpu", action="store_true")
    options = parser.parse_args()
    if jax.default_backend() != "gpu" and not options.cpu:
        sys.exit(f"JAX uses its backend {jax.default_backend()}, not a GPU; install jax[cuda12], or give --cpu")
    ours = gladstone_rates(options.bench) if options.bench else {}
    print(datetime.date.today().isoformat())
    print(f"device {jax.devices()[0].device_kind}, JAX backend {jax.default_backend()}, driver",
          first_line("nvidia-smi", "--query-gpu=driver_version", "--format=csv,noheader"))  # fmt: skip
    print(", ".join(f"{name} {version(name)}" for name in ("synthpix", "jax", "jaxlib")))
    if options.bench:
        print(first_line(pathlib.Path(options.bench).with_name("gladstone"), "--version"))
    print("pairs/s: side [px], flow, batch, SynthPix, gladstone")
    for side, batches in BATCHES.items():
        for own in (False, True):
            best = [0.0, 0.0]
            for batch in batches:
                rates = synthpix_rate(side, batch, batch if own else 1, options.rounds), ours.get((side, batch, own), 0.0)
                best = [max(pair) for pair in zip(best, rates)]
                report(side, own, batch, rates)
            report(side, own, "best", best)


if __name__ == "__main__":
    main()
