"""batches.py [--device auto] [--side 256 512 1024] [--batch 64] [--rounds 20]: time of batches with another flow per pair.

Prints pairs per second of gladstone.RenderedBatches with the same flow for all pairs, another flow per batch, another flow
per pair, and other particles too, and the time in which the models of a batch are built. With CuPy, the arrays are
taken by it. Median of the rounds, after two.
"""
import argparse
import itertools
import statistics
import time

import gladstone as gs

SETUP = {
    "experiment": "piv",
    "camera": {"pixel_pitch_um": 5.0, "bit_depth": 12},
    "lens": {"focal_length_mm": 105.0, "f_number": 16.0},
    "geometry": {"z_a_mm": 750.0},
    "particles": {"per_pixel": 0.05, "scattering": "gaussian"},
    "laser": {"thickness_mm": 1.0},
    "flow": {"kind": "lamb_oseen", "circulation_m2_s": 0.05, "core_radius_mm": 1.0, "dt_us": 10.0},
}


def variations(batch):
    """Returns the functions for the argument `vary` of RenderedBatches, by name."""

    def strength(random):
        return {"flow.circulation_m2_s": random.uniform(0.01, 0.1)}

    def density(random):
        return strength(random) | {"particles.per_pixel": random.uniform(0.03, 0.05)}

    return {
        "one flow": None,
        "another flow per batch": lambda k, random: strength(random),
        "another flow per pair": lambda k, random: [strength(random) for _ in range(batch)],
        "another flow and density per pair": lambda k, random: [density(random) for _ in range(batch)],
    }


def median(seconds):
    return statistics.median(seconds[2:])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--device", default="auto")
    parser.add_argument("--side", type=int, nargs="+", default=[256, 512, 1024])
    parser.add_argument("--batch", type=int, default=64)
    parser.add_argument("--rounds", type=int, default=20)
    options = parser.parse_args()
    try:
        import cupy
    except ImportError:
        cupy = None
    build = gs.build()
    print(f"gladstone {build['version']} ({build['commit']}), {gs.threads()} threads, device {options.device}, batches of {options.batch}, "
          f"{'CuPy ' + cupy.__version__ if cupy else 'without CuPy'}")  # fmt: skip
    for side in options.side:
        size = 34.0 * side / 1024
        setup = gs.Setup.from_dict(SETUP).replace({"camera.pixels": [side, side], "particles.volume_mm": [size, size, 1.0]})
        for name, vary in variations(options.batch).items():
            batches = gs.RenderedBatches(setup, options.batch, vary, device=options.device)
            wall, models = [], []
            start = time.perf_counter()
            for images, flow in itertools.islice(batches, options.rounds + 2):
                if cupy and images.__dlpack_device__()[0] == 2:
                    images, flow = cupy.from_dlpack(images), cupy.from_dlpack(flow)
                wall.append(time.perf_counter() - start)
                start = time.perf_counter()
            for k in range(options.rounds + 2 if vary else 0):
                changes = batches._draw(k)[1]
                start = time.perf_counter()
                batches._build(changes)
                models.append(time.perf_counter() - start)
            cost = f", models of a batch {1e3 * median(models):.2f} ms" if models else ""
            print(f"{side} x {side} px, {name}: {options.batch / median(wall):.0f} pairs/s{cost}", flush=True)


if __name__ == "__main__":
    main()
