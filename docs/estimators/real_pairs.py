"""real_pairs.py GLADSTONE A B [A B ..]: how well do the vectors of gladstone and OpenPIV match real image pairs?

Measures each pair by the default of gladstone, by its last pass run twice, and by OpenPIV's windef (0.26.1, SciPy
backend, overlap 0.5) with four sets of windows, and prints the results of match.py for them. The pairs of
docs/estimators.md are test1/exp1_001_a.bmp, _b.bmp of the package openpiv, and PIVlab_Karman_01, _02.bmp and
Jet_0001A, B.jpg in Example_data of a clone of Shrediquette/PIVlab.

Needs: pip install openpiv==0.26.1 scipy imageio tifffile
"""

import os
import pathlib
import subprocess
import sys
import tempfile

from imageio.v3 import imread

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "peers"))
import openpiv_windef  # noqa: E402
from compare_peer import write_vectors  # noqa: E402

OWN = {"default": [], "final_passes_2": ["--set", "correlate.final_passes=2"]}
WINDOWS = ((64, 32, 16, 16), (64, 32, 16), (64, 48, 32, 24), (64, 32, 32))
MATCH = pathlib.Path(__file__).with_name("match.py")


def grey(name):
    image = imread(name)
    return image if image.ndim == 2 else image.mean(axis=-1)


def main():
    program, *images = sys.argv[1:]
    for a, b in zip(images[::2], images[1::2]):
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            for name, words in OWN.items():
                subprocess.run([program, "correlate", a, b, "-o", folder / f"{name}.csv", "--quiet", *words],
                               check=True, stdout=subprocess.DEVNULL)
            for windows in WINDOWS:
                name = "windef_" + "_".join(map(str, windows))
                write_vectors(folder / f"{name}.csv", openpiv_windef.measure(grey(a), grey(b), windows))
            print(f"{pathlib.Path(a).name}, {pathlib.Path(b).name}", flush=True)
            vectors = sorted(path.name for path in folder.glob("*.csv"))
            subprocess.run([sys.executable, MATCH, *map(os.path.abspath, (a, b)), *vectors], cwd=folder, check=True)


if __name__ == "__main__":
    main()
