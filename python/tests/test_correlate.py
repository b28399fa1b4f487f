import os
import subprocess
import sys

import numpy as np
import pytest

import gladstone as gs

SETTINGS = {"window": [32, 16], "overlap": 0.5}


def same(a, b):
    return np.array_equal(a, b, equal_nan=True)


@pytest.fixture(scope="module")
def field(case):
    return gs.correlate(case.a, case.b, device="cpu", **SETTINGS)


def test_vectors_equal_those_of_the_program(field, case, written_case):
    written = gs.Field.load(written_case / "vectors.h5")
    for name in ("x", "y", "u", "v", "sigma_u", "sigma_v", "status", "peak_ratio", "correlation"):
        assert same(getattr(field, name), getattr(written, name)), name
    assert field.shape == written.shape and len(field.shape) == 2
    assert same(case.correlate(device="cpu").u, field.u)
    assert np.isfinite(field.sigma_u[field.status == 0]).mean() > 0.5  # the default on a CPU
    assert field.uncertainty_method == written.uncertainty_method == "correlation_statistics"
    assert field.uncertainty_key == written.uncertainty_key == 'correlate.uncertainty = "auto"'
    assert field.verdict == written.verdict == "correlates"


def test_verdict_is_data(case, tmp_path):
    assert gs.correlate(case.a, case.a, device="cpu", **SETTINGS).verdict_code == "identical_frames"
    noise = np.random.default_rng(1).uniform(0, 1000, (64, 64))
    one_window = gs.correlate(noise, np.roll(noise, 1, axis=1), device="cpu", window=[64])
    one_window.save(tmp_path / "vectors.h5")
    for field in (one_window, gs.Field.load(tmp_path / "vectors.h5")):
        assert (field.verdict_code, field.verdict_number) == ("few_windows", 4.0), field.verdict
    arrays = gs.Field(field.x, field.y, field.u, field.v)
    assert (arrays.verdict, arrays.verdict_code, arrays.verdict_number) == ("", "", 0.0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int32, np.uint32, np.int64, np.uint64])
def test_images_of_any_type(field, case, dtype):
    assert same(gs.correlate(case.a.astype(dtype), case.b.astype(dtype), device="cpu", **SETTINGS).u, field.u)


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.int8])
def test_images_of_one_byte(case, dtype):
    bright = [image > np.median(image) for image in (case.a, case.b)]
    field = gs.correlate(*[image.astype(np.float64) for image in bright], device="cpu", **SETTINGS)
    assert same(gs.correlate(*[image.astype(dtype) for image in bright], device="cpu", **SETTINGS).u, field.u)


# Frames in float64 take 16 bytes per pixel of the pair, the deformed frames and their spline coefficients 32, windows
# less than 4: another copy of the pair in float64 would exceed the limit.
@pytest.mark.skipif(not os.path.exists("/proc/self/clear_refs"), reason="the peak of the memory is that of Linux")
@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float32"])
def test_images_are_copied_once(dtype):
    code = f"""
import numpy as np, gladstone as gs
gs.set_threads(1)
a = np.random.default_rng(1).integers(0, 200, (1536, 1536)).astype("{dtype}")
b = np.roll(a, 1, 1)
def memory(name):
    return 1024 * next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith(name))
gs.correlate(a[:64, :64], b[:64, :64], window=[32, 16], device="cpu")
before = memory("VmRSS")
open("/proc/self/clear_refs", "w").write("5")
gs.correlate(a, b, device="cpu")
print((memory("VmHWM") - before) / a.size)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert float(done.stdout) < 60


def test_images_of_any_layout(field, case):
    wide = np.zeros((96, 192, 2), np.uint16)
    wide[:, ::2, 0], wide[:, ::2, 1] = case.a, case.b
    assert same(gs.correlate(wide[:, ::2, 0], wide[:, ::2, 1], device="cpu", **SETTINGS).u, field.u)
    fortran = np.asfortranarray(case.a)
    assert same(gs.correlate(fortran, case.b, device="cpu", **SETTINGS).u, field.u)


def test_images_of_foreign_bytes_and_of_xarray(field, case):
    xarray = pytest.importorskip("xarray")
    assert same(gs.correlate(case.a.astype(">u2"), case.b.astype(">f4"), device="cpu", **SETTINGS).u, field.u)
    labelled = [xarray.DataArray(image, dims=("y", "x")) for image in (case.a, case.b)]
    assert same(gs.correlate(*labelled, device="cpu", **SETTINGS).u, field.u)


# All ways to exclude the pixels of the left half: NaN, numpy.ma, and an array of bool.
@pytest.mark.filterwarnings("ignore::gladstone.GladstoneWarning")
def test_masked_pixels_are_excluded(case):
    mask = np.zeros(case.a.shape, bool)
    mask[:, :48] = True
    expected = gs.correlate(*(np.where(mask, np.nan, image) for image in (case.a, case.b)), device="cpu", **SETTINGS)
    assert (expected.status == 2).any() and expected.valid.any()
    masked = gs.correlate(*(np.ma.array(image, mask=mask) for image in (case.a, case.b)), device="cpu", **SETTINGS)
    assert same(masked.status, expected.status) and same(masked.u, expected.u)
    given = gs.correlate(case.a, case.b, mask=mask, device="cpu", **SETTINGS)
    assert same(given.status, expected.status) and same(given.u, expected.u)


def test_masked_vectors_are_invalid():
    x, y = np.meshgrid([0.0, 8.0], [0.0, 8.0])
    u = np.ma.array(np.ones((2, 2)), mask=[[True, False], [False, False]])
    assert gs.Field(x, y, u, np.zeros((2, 2))).valid.tolist() == [[False, True], [True, True]]


def test_images_of_torch(field, case):
    torch = pytest.importorskip("torch")
    a, b = (torch.from_numpy(image.astype(np.float32)) for image in (case.a, case.b))
    assert same(gs.correlate(a, b, device="cpu", **SETTINGS).u, field.u)


@pytest.fixture
def cupy():
    library = pytest.importorskip("cupy")
    try:
        library.zeros(1)
    except library.cuda.runtime.CUDARuntimeError as error:
        pytest.skip(f"no usable GPU: {error}")
    return library


def test_images_of_cupy(cupy, field, case):
    a, b = (cupy.asarray(image) for image in (case.a, case.b))
    assert same(gs.correlate(a, b, device="cpu", **SETTINGS).u, field.u)
    back = cupy.from_dlpack(cupy.asarray(field.u))
    assert same(cupy.asnumpy(back), field.u)
    dense = gs.Field.from_dense(cupy.stack([a.astype(float), b.astype(float)], axis=-1))
    assert same(dense.u, case.a) and same(dense.v, case.b)


# Whatever their type and memory layout, images of a GPU give the vectors of the same images in host memory.
@pytest.mark.parametrize("type", ["uint16", "int32", "uint64", "float32", "float64"])
def test_images_stay_on_the_gpu(cupy, case, codes, type):
    a, b = case.a.astype(type), case.b.astype(type)
    expected = gs.correlate(a, b, device="cuda", **SETTINGS)
    wide = cupy.zeros((192, 96), type)
    wide[1::2] = cupy.asarray(a)
    with cupy.cuda.Stream(non_blocking=True):
        on_gpu = cupy.asfortranarray(cupy.asarray(b) + cupy.asarray(0, type))
        measured = gs.correlate(wide[1::2], on_gpu, device="cuda", **SETTINGS)
    assert measured.device == "cuda"
    assert same(measured.u, expected.u) and same(measured.v, expected.v) and same(measured.status, expected.status)
    with pytest.warns(gs.GladstoneWarning) as caught:
        case.compare(measured)
    assert any(one.startswith("inconsistent") for one in codes(caught))


def test_images_of_a_gpu_are_checked_like_others(cupy, case, refused):
    a, b = cupy.asarray(case.a.astype(float)), cupy.asarray(case.b.astype(float))
    a[:, :8] = cupy.nan
    with pytest.warns(gs.GladstoneWarning, match=f"a: {8 * 96} of {96 * 96} "):
        gs.correlate(a, b, **SETTINGS)
    with refused(gs.DataError, "wrong_shape at b"):
        gs.correlate(a, b[:64], **SETTINGS)
    with refused(gs.DataError, "invalid_value at b"):
        gs.correlate(a, cupy.full_like(b, cupy.nan), **SETTINGS)
    with pytest.raises(ValueError, match="a has|b has"):
        gs.correlate(a, b[None], **SETTINGS)
    with refused(gs.DataError, "wrong_type at a", "float16"):
        gs.correlate(a.astype("float16"), b.astype("float16"), **SETTINGS)
    # settings that the GPU does not support, and arrays in different memories
    mixed = gs.correlate(a, case.b, **SETTINGS)
    assert same(gs.correlate(a, b, **SETTINGS).u, mixed.u)
    image_matching = gs.correlate(a, b, uncertainty="image_matching", **SETTINGS)
    assert image_matching.uncertainty_method == "image_matching"


class OnlyDLPack:
    """Array that supports the DLPack protocol only."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **words):
        return self.array.__dlpack__(**words)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def test_images_by_dlpack(field, case):
    a, b = (OnlyDLPack(image.copy()) for image in (case.a, case.b))
    assert same(gs.correlate(a, b, device="cpu", **SETTINGS).u, field.u)


@pytest.mark.parametrize("settings, method, reason", [
    ({"window": [32]}, "none", 'correlate.uncertainty = "auto" (correlate.window_px has a single pass)'),
    ({"uncertainty": "image_matching"}, "image_matching", 'correlate.uncertainty = "image_matching"'),
])  # fmt: skip
def test_method_of_the_uncertainty_is_recorded(case, tmp_path, settings, method, reason):
    field = gs.correlate(case.a, case.b, device="cpu", **{**SETTINGS, **settings})
    field.save(tmp_path / "vectors.h5")
    for one in (field, gs.Field.load(tmp_path / "vectors.h5")):
        assert (one.uncertainty_method, one.uncertainty_key) == (method, reason)
    assert np.isfinite(field.sigma_u).any() == (method != "none")


def test_settings_are_checked(case):
    with pytest.raises(gs.SetupError) as caught:
        gs.correlate(case.a, case.b, window=[31], method="scd")
    assert {problem.key for problem in caught.value.problems} == {"window", "method"}


def test_images_are_checked(case, refused):
    with refused(gs.DataError, "wrong_shape at b"):
        gs.correlate(case.a, case.b[:50], window=32)
    with refused(gs.DataError, "wrong_shape at a", "window"):
        gs.correlate(case.a[:20, :20], case.b[:20, :20], window=32)
    with refused(gs.DataError, "wrong_type at a"):
        gs.correlate(case.a.astype(complex), case.b.astype(complex), window=32)


def test_files_round_trip(field, tmp_path):
    for name in ("vectors.h5", "vectors.csv", "vectors.dat"):
        field.save(tmp_path / name)
        assert same(gs.Field.load(tmp_path / name).u, field.u), name
    with pytest.raises(gs.OutputError):
        field.save(tmp_path / "vectors.txt")


def test_field_of_arrays_is_sorted_as_a_grid():
    y, x = np.mgrid[0:4, 0:5] * 8.0
    field = gs.Field(x[::-1], y[::-1], x[::-1] / 10, y[::-1] / 10)
    assert field.shape == (4, 5)
    assert same(field.u, x / 10) and same(field.v, y / 10)


def test_xarray_is_in_the_schema_of_pivpy(field):
    pytest.importorskip("xarray")
    data = field.to_xarray()
    assert data["u"].dims == ("y", "x", "t") and set(data.data_vars) >= {"u", "v", "chc"}
    assert same(data["u"].values[:, :, 0], field.u)
    again = gs.Field.from_xarray(data)
    counts = field.valid
    assert same(again.u[counts], field.u[counts]) and same(again.x, field.x)


def test_module_needs_no_optional_package():
    code = "import sys, gladstone; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    for name in ("matplotlib", "pandas", "torch", "tqdm", "xarray"):
        assert name not in done.stdout.split()
