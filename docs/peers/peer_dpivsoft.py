"""python3 docs/peers/peer_dpivsoft.py build/bin/gladstone: DPIVSoft on the CPU compared with gladstone.

Two passes of 64 and 32 px at overlap 0.5 with deformed windows, median test, and its other defaults. Its loop over the
windows is Python; its implementation for OpenCL is not measured.

Needs: pip install dpivsoft==0.16.0 numpy==2.4.6 tifffile==2026.3.3
"""

from importlib.metadata import version

import numpy as np
from dpivsoft import DPIV
from dpivsoft.Classes import Parameters

from compare_peer import compare, timed


def boxes(side, window, margin):
    """Number of windows along a side of the image at overlap 0.5."""
    return round((side - margin) / (window / 2)) + 1


def two_passes(a, b):
    rows, columns = a.shape
    Parameters.box_size_1_x = Parameters.box_size_1_y = 64
    Parameters.box_size_2_x = Parameters.box_size_2_y = 32
    Parameters.no_boxes_1_x, Parameters.no_boxes_1_y = boxes(columns, 64, 66), boxes(rows, 64, 66)
    Parameters.no_boxes_2_x, Parameters.no_boxes_2_y = boxes(columns, 32, 102), boxes(rows, 32, 102)
    a, b = 1 + a.astype(np.float32), 1 + b.astype(np.float32)  # as its load_images()
    x, y, u, v, _ = DPIV.processing(a, b)
    return x - 0.5, y - 0.5, u, v  # from pixel edges to pixel centres


compare(__doc__.splitlines()[0], {"DPIVSoft, CPU, 64 and 32 px": timed(two_passes)},
        f"dpivsoft {version('dpivsoft')}")
