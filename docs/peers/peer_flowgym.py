"""python3 docs/peers/peer_flowgym.py build/bin/gladstone: an estimator of Flow Gym, on JAX, compared with gladstone.

"openpiv_jax" correlates windows of 32 px once at overlap 0.5, and interpolates the displacement to every pixel, of which
every 16th along x and y is scored. Other estimators of the package were left out: "dis_jax" takes 0.4, 5 and 91 s
for images of 256, 512 and 1024 px on two busy cores, and the networks need weights that it does not contain.

Needs: pip install flow-gym-suite==0.1.0 jax==0.10.2 numpy==2.4.6 tifffile==2026.3.3
"""

from importlib.metadata import version

import jax
import numpy as np

from compare_peer import compare, timed  # before flowgym, which removes this folder from the search path

from flowgym.make import make_estimator

STEP = 16  # distance of the scored pixels, and of the windows
CONFIG = {
    "estimator": "openpiv_jax", "estimate_type": "flow",
    "config": {"jit": True, "window_size": 32, "search_size": 32, "overlap": 16,
               "openpiv_outlier_replacement_kernel_size": 1, "openpiv_outlier_replacement_n_iter": 1},
}
compiled = {}


def one_pass(a, b):
    if a.shape not in compiled:
        compiled[a.shape] = make_estimator(CONFIG, image_shape=(1, *a.shape))[:3]
    trained, create, compute = compiled[a.shape]
    state = create(a[None].astype(np.float32), jax.random.PRNGKey(0))
    state, _ = compute(b[None].astype(np.float32), state, trained)
    flow = np.asarray(state["estimates"])[0, -1]
    y, x = np.mgrid[STEP:a.shape[0]:STEP, STEP:a.shape[1]:STEP]
    return x, y, *np.moveaxis(flow[y, x], -1, 0)


compare(__doc__.splitlines()[0], {"Flow Gym, openpiv_jax": timed(one_pass)},
        f"flow-gym-suite {version('flow-gym-suite')}, jax {jax.__version__} on {jax.devices()[0].platform}")
