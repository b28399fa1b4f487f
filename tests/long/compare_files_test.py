#!/usr/bin/env python3
"""Tests of the comparison of output files, and of the setups that compare_programs.py draws."""

import json
import math
import os
import random
import struct
import sys
import tempfile
import unittest

try:
    import tomllib  # Python 3.11

    import h5py
    import numpy

    import compare_files
    import random_setups
except ModuleNotFoundError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)  # ctest: skipped


def write_tiff(path, pixels, software):
    """A TIFF of one strip with 16-bit pixels, whose text `Software` is compared by nobody."""
    text = software.encode() + b"\0"
    start = 8 + pixels.nbytes + len(text)
    tags = [(256, 4, 1, pixels.shape[1]), (257, 4, 1, pixels.shape[0]), (258, 3, 1, 16), (259, 3, 1, 1),
            (273, 4, 1, 8), (279, 4, 1, pixels.nbytes), (305, 2, len(text), 8 + pixels.nbytes)]
    with open(path, "wb") as file:
        file.write(b"II*\0" + struct.pack("<I", start) + pixels.tobytes() + text + struct.pack("<H", len(tags)))
        file.write(b"".join(struct.pack("<HHII", *tag) for tag in tags) + bytes(4))


def write_case(folder, displacement, level=7, date="2026-01-01", version="0.2.0 (251f0c5a27a3)", seconds=1.0):
    os.makedirs(folder)
    write_tiff(os.path.join(folder, "flow.tif"), numpy.full((3, 4), level, "<u2"), date)
    with h5py.File(os.path.join(folder, "truth.h5"), "w") as file:
        file.attrs["date_and_time"] = date
        file.attrs["made_from"] = f"{version} mid"
        file["dots/displacement_px"] = displacement
        file["dots/displacement_px"].attrs["units"] = "px"
        file["dots/seconds_each"] = [seconds]
    with open(os.path.join(folder, "summary.json"), "w") as file:
        json.dump({"rays": {"alive": [1, 2, None]}, "seconds_render": seconds, "largest": float(displacement[0])}, file)
    with open(os.path.join(folder, "vectors.csv"), "w") as file:
        file.write(f"x_px,u_px\n0,{displacement[0]!r}\n1,\n")


class Comparison(unittest.TestCase):
    def compare(self, displacement, **other):
        """Returns the differences from a case with displacements 0.5 and NaN, by file and dataset."""
        with tempfile.TemporaryDirectory() as folder:
            write_case(os.path.join(folder, "old"), numpy.array([0.5, math.nan]))
            write_case(os.path.join(folder, "new"), displacement, **other)
            found = compare_files.compare_folders(os.path.join(folder, "old"), os.path.join(folder, "new"))
        return {(one.file, one.dataset): one for one in found}

    def test_times_and_versions_are_not_compared(self):
        self.assertEqual(self.compare(numpy.array([0.5, math.nan]), date="2026-02-02", version="0.3.0 (abcdef01)",
                                      seconds=2.0), {})

    def test_one_bit_is_a_difference(self):
        found = self.compare(numpy.array([numpy.nextafter(0.5, 1), math.nan]))
        self.assertEqual(set(found), {("truth.h5", "dots/displacement_px"), ("summary.json", "largest"),
                                      ("vectors.csv", "u_px")})
        self.assertEqual(found["truth.h5", "dots/displacement_px"].absolute, 2.0**-53)
        self.assertAlmostEqual(found["truth.h5", "dots/displacement_px"].relative, 2.0**-52)

    def test_a_grey_level_is_a_difference(self):
        found = self.compare(numpy.array([0.5, math.nan]), level=8)
        self.assertEqual(set(found), {("flow.tif", "pixels")})
        self.assertEqual(found["flow.tif", "pixels"].absolute, 1.0)

    def test_a_number_instead_of_nan_differs_by_infinity(self):
        self.assertEqual(self.compare(numpy.array([0.5, 0.0]))["truth.h5", "dots/displacement_px"].absolute, math.inf)

    def test_another_shape_or_sign_of_zero_is_a_difference(self):
        self.assertIn("shape", compare_files.compare_values(numpy.zeros(2), numpy.zeros(3))[2])
        self.assertEqual(compare_files.compare_values(numpy.zeros(1), -numpy.zeros(1))[:2], (0.0, 0.0))
        self.assertIn("only new", [one.text for one in compare_files.compare_contents("f", {}, {"a": 1})])

    def test_the_summary_has_one_row_for_each_dataset(self):
        found = [(f"setup_{i}", compare_files.Difference("errors.json", f"bins[{i}].rms", i, 0.5, ""))
                 for i in (1, 2)]
        self.assertEqual(compare_files.summarize(found), [("errors.json", "bins[].rms", 2, 2, 0.5, "setup_2: ")])


class RandomSetups(unittest.TestCase):
    OFFERS = {
        "lens.psf": ["airy"], "lens.transmittance": ["glass"], "element.kind": ["window", "wedge"],
        "medium.field.kind": ["none", "file", "uniform_gradient", "sinusoid", "gaussian_plume", "normal_shock"],
        "medium.integrator": ["rk4"], "medium.interpolation": ["trilinear"], "medium.faces": ["matched"],
        "target.kind": ["dots", "grid", "points", "image"], "target.polarity": ["bright", "dark"],
        "target.arrangement": ["regular"], "render.method": ["auto", "rays", "focused_dots", "formula"],
        "render.sampling": ["sobol", "random"], "particles.scattering": ["mie", "gaussian"],
        "particles.material": ["dehs"], "laser.profile": ["top_hat"], "flow.kind": ["uniform", "jet", "normal_shock"],
        "correlate.method": ["scc", "tracking"], "correlate.subpixel": ["gauss3"], "correlate.weighting": ["uniform"],
        "correlate.deformation": ["sinc"], "correlate.uncertainty": ["none"], "correlate.tracking.output": ["grid"],
        "correlate.tracking.shape": ["round"], "correlate.mask.kind": ["polygon", "image", "intensity"],
        "correlate.preprocess.kind": ["clahe"],
    }  # fmt: skip

    def draw(self, index):
        with tempfile.TemporaryDirectory() as folder:
            draw = random_setups.Draw(random.Random(f"1/{index}"), self.OFFERS, folder)
            return random_setups.write_setup(random_setups.draw_setup(draw)).replace(folder, "")

    def test_are_tables_of_every_experiment_that_depend_on_the_seed_only(self):
        texts = [self.draw(index) for index in range(60)]
        self.assertEqual({tomllib.loads(text)["experiment"] for text in texts}, {"bos", "piv", "calibration"})
        self.assertEqual(texts[:5], [self.draw(index) for index in range(5)])
        self.assertEqual(len(set(texts)), 60)


if __name__ == "__main__":
    unittest.main()
