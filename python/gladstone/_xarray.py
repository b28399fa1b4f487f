"""Variables of xarray data sets."""

from __future__ import annotations

import numpy as np


def volume_variable(values, units: str, long_name: str):
    """Returns a variable over (z, y, x) as a tuple that xarray.Dataset accepts, with a copy of the values."""
    return ("z", "y", "x"), np.array(values), {"units": units, "long_name": long_name}


def grid_variable(values, units: str, long_name: str):
    """Returns a variable over (y, x) as a tuple that xarray.Dataset accepts, with a copy of the values."""
    return ("y", "x"), np.array(values), {"units": units, "long_name": long_name}
