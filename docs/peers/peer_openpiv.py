"""python3 docs/peers/peer_openpiv.py build/bin/gladstone: OpenPIV with both of its backends compared with gladstone.

One pass of 32 px at overlap 0.5 with `circular` correlation and three-point Gaussian fit: as fast as possible (neither
normalised nor validated), and normalised with peak ratio and median test, which gladstone's times contain; and windef
with 64, 32, 16 px.

Needs: pip install 'openpiv[rust]==0.26.1' numpy==2.4.6 tifffile==2026.3.3
"""

from importlib.metadata import version

import numpy as np
from openpiv import pyprocess, validation

import openpiv_windef

from compare_peer import compare, timed

WINDOW, OVERLAP = 32, 16


def one_pass(backend, complete):
    def estimate(a, b):
        u, v, ratio = pyprocess.extended_search_area_piv(
            a.astype(np.int32), b.astype(np.int32), window_size=WINDOW, overlap=OVERLAP, search_area_size=WINDOW,
            correlation_method="circular", subpixel_method="gaussian",
            sig2noise_method="peak2peak" if complete else None, normalized_correlation=complete, backend=backend)
        u, v = np.array(u), np.array(v)
        if complete:
            bad = validation.sig2noise_val(ratio, threshold=1.0) | validation.local_median_val(u, v, 2.0, 2.0)
            u[bad] = np.nan
        x, y = pyprocess.get_rect_coordinates(a.shape, WINDOW, OVERLAP)
        return x - 0.5, y - 0.5, u, v  # from pixel edges to centres; rows count downwards until transform_coordinates
    return timed(estimate)


def three_passes(backend):
    return timed(lambda a, b: openpiv_windef.measure(a, b, (64, 32, 16), backend))


peers = {}
for backend, name in (("rust", "Rust"), ("scipy", "SciPy")):
    peers[f"OpenPIV, {name} backend, one pass, correlation alone"] = one_pass(backend, complete=False)
    peers[f"OpenPIV, {name} backend, one pass"] = one_pass(backend, complete=True)
    peers[f"OpenPIV, {name} backend, windef"] = three_passes(backend)
compare(__doc__.splitlines()[0], peers, f"OpenPIV {version('openpiv')}, openpiv_rust {version('openpiv_rust')}, "
        f"scipy {version('scipy')}")
