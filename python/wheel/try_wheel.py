"""Renders, stores, correlates, compares and reports a small case with the installed package, and prints what it found."""

import os
import re
import sys
import time

import numpy as np

import gladstone as gs

LARGEST_RMS_PX = 0.1  # a displacement of whole windows or wrong sign is above, noise and gradients below 0.05 px

start = time.perf_counter()
assert os.path.realpath(gs.__file__).startswith(os.path.realpath(sys.prefix)), f"{gs.__file__} is not the wheel's"
case = gs.Setup(gs.init("bos")).replace({"camera.pixels": [96, 96]}).render()
case.save("case")
read = gs.Case.load("case")
assert np.array_equal(read.images, case.images), "the images read differ from those written"
report = case.compare(read.correlate())
assert report.rms_px < LARGEST_RMS_PX, f"rms error {report.rms_px} px"

report.to_html("report.html")
with open("report.html", encoding="utf-8") as file:
    assert file.read().count("data:image/png;base64,") >= 2, "the report lacks the two frames"

with open("image.png", "wb") as file:  # no image codecs: the message names the image and the remedy
    file.write(b"\x89PNG\r\n\x1a\n")
try:
    gs.info.image("image.png")
    raise AssertionError("a PNG without content was read")
except gs.DataError as error:
    assert error.file == "image.png", error
    assert error.code != "unreadable_file" or "pass the array" in error.text, error

with open("/proc/self/maps", encoding="utf-8") as maps:
    libraries = sorted(set(re.findall(r"\S+/(?:lib)\S+\.so[.\d]*$", maps.read(), re.MULTILINE)))
windows = [path for path in libraries if re.search(r"/lib(X|xcb|GL)[^/]*$", path) and not path.startswith(sys.prefix)]
assert not windows, f"libraries of X11 outside of the wheel are loaded: {windows}"
print(f"gladstone {gs.__version__}: rendered, stored, correlated, compared and reported {case!r} in "
      f"{time.perf_counter() - start:.1f} s, rms error {report.rms_px:.4f} px")
