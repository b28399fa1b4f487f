"""match.py A B VECTORS..: deforms both frames symmetrically by each file of vectors, and prints the rms difference of
deformed frames relative to the rms of their mean (after a high-pass filter), and the fractions of vectors whose
normalised median residual is above 2 and above 3."""
import sys
import warnings

import numpy as np
from imageio.v3 import imread
from scipy.ndimage import gaussian_filter, map_coordinates, spline_filter
from scipy.interpolate import griddata, RectBivariateSpline
warnings.filterwarnings("ignore")  # of empty medians at holes

a, b = (imread(f).astype(float) for f in sys.argv[1:3])
high = lambda f: f - gaussian_filter(f, 10)
a, b = spline_filter(high(a), 5), spline_filter(high(b), 5)
yy, xx = np.mgrid[:a.shape[0], :a.shape[1]].astype(float)
def fields(name):
    if name.endswith('.csv'):
        t = np.genfromtxt(name, delimiter=',', names=True)
        x, y, u, v = t['x_px'], t['y_px'], t['u_px'], t['v_px']
    else:
        x, y, u, v = np.loadtxt(name)[:, :4].T
        y, v = y.min() + y.max() - y, -v          # y upwards
        x, y = x - 0.5, y - 0.5
    gx, gy = np.unique(np.round(x, 3)), np.unique(np.round(y, 3))
    order = np.lexsort((x, y)); shape = (gy.size, gx.size)
    return gx, gy, u[order].reshape(shape), v[order].reshape(shape)
def filled(f):
    bad = ~np.isfinite(f)
    if bad.any():
        j, i = np.indices(f.shape)
        f = f.copy(); f[bad] = griddata((j[~bad], i[~bad]), f[~bad], (j[bad], i[bad]), method='nearest')
    return f
def outliers(u, v):
    res = np.zeros(u.shape)
    for f in (u, v):
        p = np.pad(f, 1, constant_values=np.nan)
        n = np.stack([p[j:j + f.shape[0], i:i + f.shape[1]] for j in range(3) for i in range(3) if (j, i) != (1, 1)])
        m = np.nanmedian(n, 0); r = np.nanmedian(np.abs(n - m), 0)
        res = np.hypot(res, np.abs(f - m) / (r + 0.2))
    return [np.mean((res > t) | ~np.isfinite(u)) for t in (2, 3)]
inner = (slice(32, -32),) * 2
for name in sys.argv[3:]:
    gx, gy, u, v = fields(name)
    k = lambda f: RectBivariateSpline(gy, gx, filled(f), kx=3, ky=3)(np.clip(np.arange(a.shape[0]), gy[0], gy[-1]), np.clip(np.arange(a.shape[1]), gx[0], gx[-1]))
    U, V = k(u), k(v)
    A = map_coordinates(a, [yy - V / 2, xx - U / 2], order=5, prefilter=False, mode='nearest')[inner]
    B = map_coordinates(b, [yy + V / 2, xx + U / 2], order=5, prefilter=False, mode='nearest')[inner]
    scale = np.sqrt(((A + B) ** 2).mean()) / 2
    o2, o3 = outliers(u, v)
    d = A - B
    print("%-40s rms difference of the matched frames %.4f grey levels, their rms %.2f, ratio %.4f; median difference %.3f; normalized residual above 2: %.2f %%, above 3: %.2f %% of %d vectors" % (name, np.sqrt((d ** 2).mean()), scale, np.sqrt((d ** 2).mean()) / scale, np.median(np.abs(d)), 100 * o2, 100 * o3, u.size))
