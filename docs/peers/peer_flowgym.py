"""python3 docs/peers/peer_flowgym.py build/bin/gladstone: two estimators of Flow Gym, on JAX, beside gladstone.

"openpiv_jax" correlates windows of 32 px once at overlap 0.5; "dis_jax" is the dense inverse search with patches of 9 px
and its other defaults. Both return a displacement at every pixel, of which every 8th pixel along x and y is scored. The
networks of Flow Gym (RAFT) need trained weights, which are not part of the package.

Needs: pip install flow-gym-suite==0.1.0 jax==0.10.2 numpy==2.4.6 tifffile==2026.3.3
"""

from importlib.metadata import version

import jax
import numpy as np

from compare_peer import compare, timed  # before flowgym, which removes this folder from the search path

from flowgym.make import make_estimator

STEP = 8  # distance of the scored pixels


def flow_gym(name, first_frame, **settings):
    """Returns an estimator by its name in Flow Gym.

    first_frame: whether its displacements are those of the pixels of the first frame, or else of the mid-position.
    """
    compiled = {}

    def estimate(a, b):
        if a.shape not in compiled:
            compiled[a.shape] = make_estimator({"estimator": name, "estimate_type": "flow",
                                                "config": {"jit": True, **settings}}, image_shape=(1, *a.shape))[:3]
        trained, create, compute = compiled[a.shape]
        state = create(a[None].astype(np.float32), jax.random.PRNGKey(0))
        state, _ = compute(b[None].astype(np.float32), state, trained)
        flow = np.asarray(state["estimates"])[0, -1]
        y, x = np.mgrid[STEP // 2:a.shape[0]:STEP, STEP // 2:a.shape[1]:STEP]
        u, v = np.moveaxis(flow[y, x], -1, 0)
        return (x + u / 2, y + v / 2, u, v) if first_frame else (x, y, u, v)
    return timed(estimate)


compare(__doc__.splitlines()[0], {
    "Flow Gym, openpiv_jax, 32 px": flow_gym(
        "openpiv_jax", False, window_size=32, search_size=32, overlap=16, openpiv_outlier_replacement_kernel_size=1,
        openpiv_outlier_replacement_n_iter=1),
    "Flow Gym, dis_jax": flow_gym("dis_jax", True),
}, f"flow-gym-suite {version('flow-gym-suite')}, jax {jax.__version__} on {jax.devices()[0].platform}")
