"""Computes vectors by the steps of OpenPIV's windef.piv(), for two images in memory. Outliers of the first pass are
detected and replaced here; in later passes windef.multipass_img_deform() does both. Imported by peer_openpiv.py,
steep_gradients.py and estimators/real_pairs.py.

Needs: pip install openpiv==0.26.1
"""

import numpy as np
from openpiv import filters, validation, windef


def measure(a, b, windows, backend="scipy"):
    """Returns x, y, u, v [px] at overlap 0.5, x and y from 0 at the first pixel's centre; NaN: invalid.

    @raises ValueError: all vectors of a pass are rejected
    """
    settings = windef.PIVSettings()
    settings.windowsizes, settings.overlap = tuple(windows), tuple(size // 2 for size in windows)
    settings.num_iterations, settings.backend = len(windows), backend
    settings.show_all_plots, settings.static_mask = False, None
    a, b = a.astype(np.int32), b.astype(np.int32)
    x, y, u, v, ratio = windef.first_pass(a, b, settings)
    u, v = np.ma.masked_array(u, mask=np.ma.nomask), np.ma.masked_array(v, mask=np.ma.nomask)
    if settings.num_iterations > 1:
        flags = validation.typical_validation(u, v, ratio, settings)
        u, v = filters.replace_outliers(u, v, flags, method=settings.filter_method,
                                        max_iter=settings.max_filter_iteration, kernel_size=settings.filter_kernel_size)
    for i in range(1, settings.num_iterations):
        x, y, u, v, _, _ = windef.multipass_img_deform(a, b, i, x, y, u, v, settings)
    return x - 0.5, y - 0.5, np.ma.filled(u, np.nan), np.ma.filled(v, np.nan)
