"""PIVlab under GNU Octave, imported by peer_pivlab.py and steep_gradients.py: three passes of 64, 32 and 16 px (piv_FFTmulti, three-point
fit, deformation by splines), then the validation of PIVlab's example for the command line: standard deviation 7, median
3, removed vectors filled.

Octave 7 does not run PIVlab's files as they are. Copies of four of them are changed, without effect on the results:
blocks `arguments` become loops over names and values, calls with name=value become name, value; means over NaN and over
two dimensions are written out; and `interp2` with splines, for which Octave requires a rectangular grid, becomes
deform.m, cubic B-splines as in MATLAB except within some pixels of the border (not-a-knot there, mirrored here).
"""

import pathlib
import re
import subprocess
import tempfile

import numpy as np

FILES = ("+piv/piv_FFTmulti.m", "+postproc/PIVlab_postproc.m", "+misc/inpaint_nans.m", "+misc/smoothn.m")

DEFORM = """function values = deform(image, x, y)
% Values of an image at columns x and rows y by cubic B-splines with mirrored borders; outside, the nearest value.
[rows, columns] = size(image);
c = (matrix(rows) \\ double(image)) / matrix(columns)';
x = min(max(x, 1), columns); y = min(max(y, 1), rows);
i = min(floor(x), columns - 1); j = min(floor(y), rows - 1);
wx = weights(x - i); wy = weights(y - j);
values = zeros(size(x));
for k = 1:4
  for l = 1:4
    at = sub2ind([rows, columns], mirror(j + l - 2, rows), mirror(i + k - 2, columns));
    values += wy{l} .* wx{k} .* reshape(c(at), size(x));
  end
end
end
function i = mirror(i, n)
i(i < 1) = 2 - i(i < 1); i(i > n) = 2 * n - i(i > n);
end
function w = weights(t)
w = {(1 - t).^3 / 6, (3 * t.^3 - 6 * t.^2 + 4) / 6, (-3 * t.^3 + 3 * t.^2 + 3 * t + 1) / 6, t.^3 / 6};
end
function m = matrix(n)
m = spdiags(ones(n, 1) * [1, 4, 1] / 6, -1:1, n, n);
m(1, 2) *= 2; m(n, n - 1) *= 2;
end
"""

RUN = """pkg load image
warning off
addpath(pwd)
lines = fopen('pairs.txt');
while ischar(folder = fgetl(lines))
  a = imread(fullfile(folder, 'a.tif')); b = imread(fullfile(folder, 'b.tif'));
  start = tic;
  [x, y, u, v] = piv.piv_FFTmulti('image1', a, 'image2', b, 'interrogationarea', 64, 'step', 32, 'passes', 3, ...
    'int2', 32, 'int3', 16, 'imdeform', '*spline');
  [u, v] = postproc.PIVlab_postproc('u', u, 'v', v, 'valid_vel', [-50; 50; -50; 50], 'do_stdev_check', 1, ...
    'stdthresh', 7, 'do_local_median', 1, 'neigh_thresh', 3);
  removed = isnan(u) | isnan(v);
  u = misc.inpaint_nans(double(u), 4); v = misc.inpaint_nans(double(v), 4);
  seconds = toc(start);
  vectors = double([x(:), y(:), u(:), v(:), removed(:)]);
  save('-text', fullfile(folder, 'seconds.txt'), 'seconds');
  save('-text', fullfile(folder, 'pivlab.txt'), 'vectors');
end
"""


def convert(text):
    """Rewrites a file of PIVlab for Octave 7."""
    block = re.search(r"^arguments\n(.*?)^end\n", text, re.DOTALL | re.MULTILINE)
    if block:
        defaults = re.findall(r"opts\.(\w+) *= *(.*)", block.group(1))
        lines = "".join(f"opts.{name} = {value};\n" for name, value in defaults)
        loop = "for k = 1:2:numel(varargin)\nopts.(varargin{k}) = varargin{k + 1};\nend\n"
        text = re.sub(r"\(opts\)\n", "(varargin)\n", text.replace(block.group(0), lines + loop), count=1)
    text = re.sub(r"postproc\.PIVlab_postproc\(.*?\);",
                  lambda call: re.sub(r"(\w+)=", r"'\1', ", call.group(0)), text, flags=re.DOTALL)
    text = text.replace("mean(result_conv, 1:2)", "mean(mean(result_conv, 1), 2)")
    text = text.replace("mean(deltau(:)+deltav(:),'omitnan')", "mean((deltau+deltav)(~isnan(deltau+deltav)))")
    text = re.sub(r"mean\((\w)\(:\),'omitnan'\)", r"mean(\1(~isnan(\1)))", text)
    text = re.sub(r"std\(reshape\((\w),.*?\),'omitnan'\)", r"std(\1(~isnan(\1)))", text)
    place = "double(X2) - image_roi_xs(1) + 1, double(Y2) - image_roi_ys(1) + 1"
    return text.replace("interp2(image_roi_xs,image_roi_ys,image2_roi,X2,  Y2,  imdeform)",
                        f"single(deform(image2_roi, {place}))")


def measure(repository, folders):
    """Yields x, y, u, v [px] of the pair a.tif, b.tif of each folder; x and y from 0 at the first pixel's centre."""
    for _, vectors in measure_with_times(repository, folders):
        yield vectors


def measure_with_times(repository, folders):
    """Yields the time without start and reading [s], and the vectors of measure()."""
    with tempfile.TemporaryDirectory() as temporary:
        work = pathlib.Path(temporary)
        for name in FILES:
            (work / name).parent.mkdir(exist_ok=True)
            text = (pathlib.Path(repository) / name).read_text(encoding="latin-1")
            (work / name).write_text(convert(text), encoding="latin-1")
        (work / "deform.m").write_text(DEFORM)
        (work / "pairs.txt").write_text("".join(f"{folder}\n" for folder in folders))
        (work / "run.m").write_text(RUN)
        done = subprocess.run(["octave-cli", "run.m"], cwd=work, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(done.stdout + done.stderr)
        for folder in folders:
            x, y, u, v, _ = np.loadtxt(folder / "pivlab.txt").T
            seconds = float(np.loadtxt(folder / "seconds.txt"))
            yield seconds, (x - 1.0, y - 1.0, u, v)  # from 1 to 0; uniform gradients are then measured without bias
