"""python3 docs/peers/peer_ffpiv.py build/bin/gladstone: ffpiv compared with gladstone.

One pass of 32 px at overlap 0.5 with each engine that is installed, normalised windows, without validation.

Needs: pip install ffpiv==0.2.1 numpy==2.4.6 tifffile==2026.3.3 (the engine "numba" also rocket-fft, for Python <= 3.12)
"""

from importlib.metadata import version

import ffpiv
import numpy as np

from compare_peer import compare, timed

WINDOW, OVERLAP = (32, 32), (16, 16)


def one_pass(engine):
    def estimate(a, b):
        u, v = ffpiv.piv(a, b, window_size=WINDOW, overlap=OVERLAP, engine=engine, normalize=True)
        x, y = ffpiv.coords(a.shape, window_size=WINDOW, overlap=OVERLAP)
        x, y = np.meshgrid(np.asarray(x) - 0.5, np.asarray(y) - 0.5)  # from pixel edges to pixel centres
        return x, y, u, v
    return timed(estimate)


engines = ["fftw", "numpy"] + (["numba"] if ffpiv.HAS_ROCKET_FFT else [])
compare(__doc__.splitlines()[0], {f"ffpiv, {engine}": one_pass(engine) for engine in engines},
        f"ffpiv {version('ffpiv')}")
