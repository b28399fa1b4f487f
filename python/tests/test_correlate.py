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


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int32, np.uint32, np.int64])
def test_images_of_any_type(field, case, dtype):
    assert same(gs.correlate(case.a.astype(dtype), case.b.astype(dtype), device="cpu", **SETTINGS).u, field.u)


def test_images_of_any_layout(field, case):
    wide = np.zeros((96, 192, 2), np.uint16)
    wide[:, ::2, 0], wide[:, ::2, 1] = case.a, case.b
    assert same(gs.correlate(wide[:, ::2, 0], wide[:, ::2, 1], device="cpu", **SETTINGS).u, field.u)
    fortran = np.asfortranarray(case.a)
    assert same(gs.correlate(fortran, case.b, device="cpu", **SETTINGS).u, field.u)


def test_images_of_torch(field, case):
    torch = pytest.importorskip("torch")
    a, b = (torch.from_numpy(image.astype(np.float32)) for image in (case.a, case.b))
    assert same(gs.correlate(a, b, device="cpu", **SETTINGS).u, field.u)


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


def test_settings_are_checked(case):
    with pytest.raises(gs.SetupError) as caught:
        gs.correlate(case.a, case.b, window=[31], method="scd")
    assert {problem.key for problem in caught.value.problems} == {"correlate.window_px", "correlate.method"}


def test_images_are_checked(case):
    with pytest.raises(gs.DataError, match="size"):
        gs.correlate(case.a, case.b[:50], window=32)
    with pytest.raises(gs.DataError, match="window"):
        gs.correlate(case.a[:20, :20], case.b[:20, :20], window=32)
    with pytest.raises(gs.DataError, match="type"):
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
