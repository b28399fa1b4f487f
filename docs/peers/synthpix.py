"""synthpix.py [--bench BENCH] [--batch 64] [--rounds 20]: pairs per second of SynthPix and of gladstone on one GPU.

SynthPix draws pairs of Gaussian particle images of 256, 512 and 1024 px from one flow field: 0.05 particles per pixel,
3.3 px wide (e^-2), no noise, no hidden particles. gladstone's `pair_batches` draws the same number of particles of the
same size, as illuminated by a Gaussian sheet and seen through a lens (tests/benchmarks/cuda/pair_batches_bench.cpp). Both
leave the images on the GPU. Batches are warmed up twice; the median of the rounds counts. In SynthPix 0.3.1
(generate.py), diameters are standard deviations times 2, hence 1.65 here, and a particle is drawn on 5 x 5 px, sampled at
their centres; gladstone integrates over 11 x 11 px.

Needs a GPU, pip install synthpix==0.3.1 'jax[cuda12]', and for gladstone BENCH = build/cuda/bin/gladstone_cuda_bench.
"""
import sys

sys.path.pop(0)  # this folder, where synthpix.py would be taken for the package

import argparse
import json
import statistics
import subprocess
import time
from importlib.metadata import version

import jax
import jax.numpy as jnp
from synthpix.data_generate import generate_images_from_flow
from synthpix.types import ImageGenerationSpecification


def synthpix_rate(side, batch, rounds):
    specification = ImageGenerationSpecification(
        batch_size=batch, image_shape=(side, side), img_offset=(16, 16), seeding_density_range=(0.05, 0.05),
        p_hide_img1=0.0, p_hide_img2=0.0, diameter_ranges=[(1.65, 1.65)], diameter_var=0.0,
        intensity_ranges=[(200, 200)], intensity_var=0.0, rho_ranges=[(0.0, 0.0)], rho_var=0.0, dt=1.0,
    )  # fmt: skip
    bounds = (side + 32, side + 32)
    x = jnp.linspace(0, 6.283, bounds[0])
    flow = 3 * jnp.stack([jnp.sin(x)[None, :] * jnp.cos(x)[:, None], -jnp.cos(x)[None, :] * jnp.sin(x)[:, None]], -1)
    draw = jax.jit(lambda key: generate_images_from_flow(key, flow[None], specification, position_bounds=bounds)[:2])
    seconds = []
    for k in range(rounds + 2):
        start = time.perf_counter()
        jax.block_until_ready(draw(jax.random.PRNGKey(k)))
        seconds.append(time.perf_counter() - start)
    return batch / statistics.median(seconds[2:])


def gladstone_rates(bench):
    command = [bench, "--benchmark_filter=pair_batches.*noise:0/own_setup:0", "--benchmark_format=json"]
    result = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    rates = {}
    for run in result["benchmarks"]:
        side = int(run["name"].split("side:")[1].split("/")[0])
        rates[side] = max(rates.get(side, 0.0), run["pairs/s"])
    return rates


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bench")
    parser.add_argument("--batch", type=int, default=64)
    parser.add_argument("--rounds", type=int, default=20)
    options = parser.parse_args()
    ours = gladstone_rates(options.bench) if options.bench else {}
    print(f"{jax.devices()[0].device_kind}, SynthPix {version('synthpix')}, JAX {version('jax')}, pairs/s")
    for side in (256, 512, 1024):
        peer = synthpix_rate(side, options.batch, options.rounds)
        print(f"{side} x {side} px: SynthPix {peer:.0f}, gladstone {ours.get(side, float('nan')):.0f}")


if __name__ == "__main__":
    main()
