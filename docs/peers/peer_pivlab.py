"""python3 docs/peers/peer_pivlab.py build/bin/gladstone --pivlab PIVlab --rounds 2: PIVlab under GNU Octave compared
with gladstone.

Three passes of 64, 32, 16 px at overlap 0.5, deformation by splines, and its own validation; see pivlab.py, which also
lists what Octave requires to be changed. The time is that of correlation and validation inside of Octave, without its
start; PIVlab is faster in MATLAB.

Needs: apt install octave-image (GNU Octave 7.3.0, image 2.14.0), pip install numpy==2.4.6 tifffile==2026.3.3, and
    git clone https://github.com/Shrediquette/PIVlab && git -C PIVlab checkout 6986f2d
"""

import argparse
import pathlib
import subprocess
import tempfile

import tifffile

import pivlab
from compare_peer import compare

COMMIT = "6986f2d"

parser = argparse.ArgumentParser(add_help=False)
parser.add_argument("--pivlab", required=True, help="clone of Shrediquette/PIVlab")
repository = parser.parse_known_args()[0].pivlab


def first_line(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()[0]


def three_passes(a, b):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        tifffile.imwrite(folder / "a.tif", a)
        tifffile.imwrite(folder / "b.tif", b)
        return next(pivlab.measure_with_times(repository, [folder]))


commit = first_line("git", "-C", repository, "rev-parse", "HEAD")
if not commit.startswith(COMMIT):
    print(f"warning: PIVlab is at {commit[:7]}, not at {COMMIT}, to which the changes for Octave fit")
compare(__doc__.splitlines()[0], {"PIVlab, three passes": three_passes},
        f"PIVlab {commit[:7]}, {first_line('octave-cli', '--version')}")
