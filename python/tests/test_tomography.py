"""Density of a volume: a Gaussian blob is the same from all sides, so that one case serves as every view."""

import numpy as np
import pytest

import gladstone as gs

BLOB = {
    "camera": {"pixels": [64, 64], "pixel_pitch_um": 40.0},
    "geometry": {"z_a_mm": 750.0, "z_d_mm": 250.0},
    "medium": {"field": {"kind": "gaussian_blob", "amplitude_kg_m3": -0.5, "radius_mm": 2.5}},
    "render": {"rays_per_dot": 32},
    "correlate": {"window_px": [16, 8]},
}
OPTIONS = {"reference": "left", "iterations": 5, "device": "cpu"}


@pytest.fixture(scope="module")
def case():
    return gs.Setup.from_dict(BLOB).render(device="cpu")


@pytest.fixture(scope="module")
def result(case):
    return gs.tomography([case] * 4, **OPTIONS)


def test_cases_in_memory_equal_the_command(result, case, program, tmp_path):
    field = case.correlate(device="cpu")
    places = [tmp_path / f"case_{i}" for i in range(4)]
    for place in places:
        case.save(place)
        field.save(place / "vectors.h5")
    printed = program("tomography", *places, "-o", tmp_path / "volume.h5", "--reference", "left",
                      "--iterations", 5, "--no-figures")  # fmt: skip
    assert printed["relative_error"] == result.summary["relative_error"]
    again = gs.tomography([case] * 4, [field] * 4, **OPTIONS)
    assert np.array_equal(again.density, result.density)
    h5py = pytest.importorskip("h5py")
    result.save(tmp_path / "again.h5")
    with h5py.File(tmp_path / "volume.h5") as file, h5py.File(tmp_path / "again.h5") as saved:
        for name, values in {
            "density_kg_m3": result.density, "x_mm": result.x_mm, "y_mm": result.y_mm, "z_mm": result.z_mm,
        }.items():  # fmt: skip
            assert np.array_equal(file[name][...], values), name
            assert np.array_equal(saved[name][...], values), name


# The blob has its least density in the middle; 5 sweeps recover more than half of the difference (relative error < 1).
def test_volume_is_that_of_the_case(result):
    assert result.density.shape == (len(result.z_mm), len(result.y_mm), len(result.x_mm))
    middle = tuple(size // 2 for size in result.density.shape)
    assert result.density[middle] < result.density.max() - 0.25 * 0.5
    least = np.unravel_index(result.truth.argmin(), result.truth.shape)
    assert np.all(np.abs(np.subtract(least, middle)) <= 1)
    assert np.array_equal(result.error, result.density - result.truth)
    assert result.views.max() == 4
    assert result.summary["relative_error"] < 1
    assert "nodes" in repr(result)


def test_xarray(result):
    pytest.importorskip("xarray")
    data = result.to_xarray()
    assert data["density"].dims == ("z", "y", "x") and data["z"].attrs["units"] == "mm"
    assert data["density"].attrs["units"] == "kg m-3"
    assert np.array_equal(data["error"].values, result.error)
    assert np.array_equal(data["x"].values, result.x_mm)


def test_plot(result):
    pytest.importorskip("matplotlib").use("agg")
    axes = result.plot().axes
    titles = [axis.get_title() for axis in axes if axis.get_title()]
    assert len(titles) == 6 and titles[0].startswith("density at z = ") and titles[3].startswith("error at z = ")


def test_setups_of_views(case, program, tmp_path):
    setup = gs.Setup.from_dict(BLOB)
    setup.save(tmp_path / "blob.toml")
    program("tomography", tmp_path / "blob.toml", "--views", 3, "--arc", 90, "-o", tmp_path / "command")
    paths = gs.tomography_setups(setup, tmp_path / "views", views=3, arc_deg=90)
    assert [path.rsplit("/", 1)[1] for path in paths] == ["view_00.toml", "view_01.toml", "view_02.toml"]
    h5py = pytest.importorskip("h5py")
    for name in ("view_00.h5", "view_02.h5"):
        with h5py.File(tmp_path / "command" / name) as file, h5py.File(tmp_path / "views" / name) as own:
            assert np.array_equal(file["density_kg_m3"][...], own["density_kg_m3"][...])
    gs.Setup.from_file(paths[1]).check()
    with pytest.raises(gs.SetupError):
        gs.tomography_setups(setup.replace({"medium.field.kind": "none"}), tmp_path / "none", views=3)


def test_problems_are_reported(case):
    with pytest.raises(gs.SetupError, match="reference"):
        gs.tomography([case] * 4, iterations=1, device="cpu")
    with pytest.raises(ValueError, match="six numbers"):
        gs.tomography([case] * 4, bounds_mm=[0, 1], **OPTIONS)
