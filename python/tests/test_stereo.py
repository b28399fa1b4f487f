import numpy as np
import pytest

import gladstone as gs


def camera(name, side):
    return {"name": name, "pixels": [128, 128], "pixel_pitch_um": 10.0, "sensor": {"scheimpflug": "auto"},
            "pose": {"position_mm": [side * 400.0, 0.0, 650.0]}}  # fmt: skip


STEREO = {
    "experiment": "piv",
    "camera": [camera("left", -1), camera("right", 1)],
    "lens": {"focal_length_mm": 105.0, "f_number": 22.0},
    "particles": {"per_pixel": 0.05, "scattering": "lambert"},
    "laser": {"thickness_mm": 0.5},
    "flow": {"velocity_m_s": [10.0, -8.0, 6.0], "dt_us": 10.0},
    "correlate": {"window_px": [32, 32], "overlap": 0.5, "uncertainty": "correlation_statistics"},
}


@pytest.fixture(scope="module")
def cases():
    return gs.Setup.from_dict(STEREO).render(device="cpu")


@pytest.fixture(scope="module")
def folders(cases, tmp_path_factory):
    """CASE folders of both cameras with their vectors."""
    place = tmp_path_factory.mktemp("stereo")
    for name, case in cases.items():
        case.save(place / name)
        case.correlate(device="cpu").save(place / name / "vectors.h5")
    return place / "left", place / "right"


@pytest.fixture(scope="module")
def result(cases):
    return gs.stereo(cases["left"], cases["right"], device="cpu")


# Of 49 nodes 35 are determined. The mean of 35 vectors with errors of 0.05 px of 0.068 mm has a standard error of 0.6 um.
def test_measures_three_components(result):
    rows, columns = result.u.shape
    assert result.x_mm.shape == (columns,) and result.y_mm.shape == (rows,)
    assert np.all(np.diff(result.x_mm) > 0) and np.all(np.diff(result.y_mm) > 0)
    for component, expected_mm in ((result.u, 0.10), (result.v, -0.08), (result.w, 0.06)):
        assert np.nanmean(component) == pytest.approx(expected_mm, abs=2e-3)
    assert result.valid.sum() > 30 and np.all(result.sigma_mm[result.valid] > 0)
    assert np.array_equal(result.error_mm, result.displacement_mm - result.truth_mm, equal_nan=True)
    assert np.allclose(result.covariance_mm2[..., 2], result.sigma_mm[..., 2] ** 2, rtol=1e-12, equal_nan=True)
    assert "nodes" in repr(result) and "residual" in str(result)


def test_equals_the_command(result, folders, program, tmp_path):
    printed = program("stereo", *folders, "-o", tmp_path / "uvw.h5", "--no-figures")
    for name, value in result.summary.items():
        if name != "vectors":
            assert value == printed[name], name
    h5py = pytest.importorskip("h5py")
    result.save(tmp_path / "again.h5")
    with h5py.File(tmp_path / "uvw.h5") as file, h5py.File(tmp_path / "again.h5") as again:
        for name in file:
            assert np.array_equal(file[name][...], again[name][...], equal_nan=True), name
        for name, values in {
            "displacement_mm": result.displacement_mm, "sigma_mm": result.sigma_mm, "truth_mm": result.truth_mm,
            "residual_px": result.residual_px, "residual_ratio": result.residual_ratio, "x_mm": result.x_mm,
            "y_mm": result.y_mm, "covariance_mm2": result.covariance_mm2,
        }.items():  # fmt: skip
            assert np.array_equal(file[name][...], values, equal_nan=True), name
        assert np.array_equal(file["status"][...] == 0, result.valid)


# All formats contain the numbers of the HDF5 file.
def test_conversion_preserves_every_bit(result, program, tmp_path):
    result.save(tmp_path / "uvw.h5")
    for ending in ("mat", "nc", "csv"):
        program("convert", tmp_path / "uvw.h5", "-o", tmp_path / f"uvw.{ending}")
    table = np.genfromtxt(tmp_path / "uvw.csv", delimiter=",", names=True)
    assert np.array_equal(table["w_mm"], result.w.ravel(), equal_nan=True)
    scipy_io = pytest.importorskip("scipy.io")
    matrices = scipy_io.loadmat(tmp_path / "uvw.mat")
    assert np.array_equal(matrices["u_mm"], result.u, equal_nan=True)
    assert np.array_equal(matrices["sigma_w_mm"], result.sigma_mm[..., 2], equal_nan=True)
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    with xarray.open_dataset(tmp_path / "uvw.nc", engine="h5netcdf") as written:
        assert written["w"].dims == ("y", "x", "t")
        assert np.array_equal(written["w"].values[..., 0], result.w, equal_nan=True)
        assert np.array_equal(written["x"].values, result.x_mm)


def test_folders_and_dewarped_images(result, folders, cases):
    again = gs.stereo(*folders, device="cpu")
    assert np.array_equal(again.displacement_mm, result.displacement_mm, equal_nan=True)
    both = gs.stereo(cases, device="cpu")
    assert np.array_equal(both.displacement_mm, result.displacement_mm, equal_nan=True)
    images = gs.stereo(cases["left"], cases["right"], dewarp="images", device="cpu")
    assert np.nanmean(images.w) == pytest.approx(0.06, abs=2e-3)


def test_problems_are_reported(cases, folders, codes, refused):
    with pytest.raises(ValueError, match="dewarp"):
        gs.stereo(*folders, dewarp="other")
    with refused(gs.DataError, "wrong_format at vectors.h5", "calibrations"):
        gs.stereo(folders[0] / "vectors.h5", folders[1] / "vectors.h5", device="cpu")
    with refused(gs.DataError, "wrong_format at left"):
        gs.stereo(folders[0], device="cpu")
    with refused(gs.DataError, "undetermined at left"):
        gs.stereo(folders[0], folders[0], device="cpu")
    with pytest.warns(gs.GladstoneWarning) as caught:
        displaced = gs.stereo(*folders, sheet_z_mm=0.5, device="cpu")
    assert "inconsistent" in codes(caught)
    assert displaced.summary["given_sheet"]["disparity_px"] > 5


def test_xarray(result):
    pytest.importorskip("xarray")
    data = result.to_xarray()
    assert data["w"].dims == ("y", "x") and data["x"].attrs["units"] == "mm"
    assert np.array_equal(data["sigma_w"].values, result.sigma_mm[..., 2], equal_nan=True)
    assert set(data) >= {"u", "v", "w", "sigma_u", "truth_w", "residual", "valid"}


def test_plot(result):
    pytest.importorskip("matplotlib").use("agg")
    titles = [axis.get_title() for axis in result.plot().axes if axis.get_title()]
    assert titles == ["u, along X [mm]", "v, along Y [mm]", "w, along Z [mm]", "residual [px]"]
