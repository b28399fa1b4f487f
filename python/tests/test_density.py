import numpy as np
import pytest

import gladstone as gs

GAUGE = {"reference": "left", "reference_density": 1.25, "reference_sigma": 0.001, "scale_uncertainty": 0.01}
OPTIONS = ("--reference", "left", "--reference-density", 1.25, "--reference-sigma", 0.001, "--scale-uncertainty", 0.01)


@pytest.fixture(scope="module")
def field(case):
    return case.correlate(device="cpu", uncertainty="correlation_statistics")


@pytest.fixture(scope="module")
def result(case, field):
    return gs.reconstruct(field, case, budget=True, device="cpu", **GAUGE)


def test_equals_the_command(result, program, case, field, tmp_path):
    place = tmp_path / "case"
    case.save(place)
    field.save(place / "vectors.h5")
    printed = program("reconstruct", place, "-o", tmp_path / "density.h5", "--no-figures", "--budget", *OPTIONS)
    for name, value in result.summary.items():
        if name != "vectors":
            assert value == printed[name], name
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "density.h5") as file:
        for name, values in {
            "density_kg_m3": result.density, "sigma_kg_m3": result.sigma, "truth_kg_m3": result.truth,
            "gradient_kg_m4": result.gradient, "x_mm": result.x_mm, "y_mm": result.y_mm,
        }.items():  # fmt: skip
            assert np.array_equal(file[name][...], values, equal_nan=True), name


def test_folder_gives_the_same_density(result, case, field, tmp_path):
    place = tmp_path / "case"
    case.save(place)
    field.save(place / "vectors.h5")
    for source, setup in ((place, None), (gs.Case.load(place), None), (place / "vectors.h5", place)):
        again = gs.reconstruct(source, setup, device="cpu", **GAUGE)
        assert np.array_equal(again.density, result.density, equal_nan=True)
        assert np.array_equal(again.sigma, result.sigma, equal_nan=True)


def test_density_is_that_of_the_case(result):
    rows, columns = result.density.shape
    assert result.x_mm.shape == (columns,) and result.y_mm.shape == (rows,)
    assert np.all(np.diff(result.x_mm) > 0) and np.all(np.diff(result.y_mm) > 0)
    assert np.all(result.density[:, 0] == 1.25) and np.all(result.reference[:, 0])
    assert result.sigma[0, 0] == pytest.approx(0.001, abs=1e-12)
    assert np.all(result.sigma >= result.sigma_random)
    assert np.array_equal(result.error, result.density - result.truth)
    causes = {name: term["bias"] for name, term in result.budget.items()}
    assert sum(bias for name, bias in causes.items() if name != "total") == pytest.approx(causes["total"], abs=1e-9)


def test_setup_of_an_experiment_has_no_truth(bos, field, result):
    measured = gs.reconstruct(field, bos, device="cpu", **GAUGE)
    assert measured.truth is None and measured.error is None and not measured.budget
    assert np.allclose(measured.density, result.density, rtol=0, atol=1e-12, equal_nan=True)


def test_references_and_methods(bos, field):
    box = gs.reconstruct(field, bos, reference=(-100, -100, 100, 100), device="cpu")
    assert np.all(box.reference)
    both = gs.reconstruct(field, bos, reference=["left:2", (-100, -100, 100, 100)], method="poisson", device="cpu")
    assert np.all(both.reference)
    flow = gs.reconstruct(field, bos, axis="x=0", abel="tikhonov", device="cpu")
    assert flow.summary["axis"]["lambda"] > 0


def test_parts_of_an_axisymmetric_flow(bos, field, refused):
    whole = gs.reconstruct(field, bos, axis="x=0", device="cpu")
    right = np.where(field.x > 47, field.u, np.nan)
    half = gs.reconstruct((field.x, field.y, right, field.v), bos, axis="x=0", device="cpu")
    assert half.summary["axis"]["asymmetry"] is None
    middle = np.nanmin(whole.density)
    assert np.nanmin(half.density) == pytest.approx(middle, abs=0.1 * (1.225 - middle))
    with refused(gs.DataError, "inconsistent at axis"):
        gs.reconstruct((field.x, field.y, right, field.v), bos, axis="vertical", device="cpu")
    with refused(gs.SetupError, "invalid_value at axis", "50 mm"):
        gs.reconstruct(field, bos, axis="x=50", device="cpu")


def test_masks_and_references(bos, field, codes, refused):
    masked = np.where(field.x < 30, np.nan, field.u)
    with refused(gs.DataError, "undetermined at reference"):
        gs.reconstruct((field.x, field.y, masked, field.v), bos, reference="left", device="cpu")
    divided = np.where(np.abs(field.x - 47.5) < 6, np.nan, field.u)
    with pytest.warns(gs.GladstoneWarning) as caught:
        half = gs.reconstruct((field.x, field.y, divided, field.v), bos, reference="left", device="cpu")
    assert "incomplete at reference" in codes(caught)
    assert ("incomplete", "reference") in [(one.code, one.place) for one in half.warnings]
    assert np.all(np.isnan(half.density[:, -1])) and np.all(np.isfinite(half.density[:, 0]))
    with pytest.warns(gs.GladstoneWarning) as caught:
        gs.reconstruct(field, bos, reference=(-100, -100, 100, 100), device="cpu")
    assert "unsuitable at reference" in codes(caught)


def test_problems_are_reported(bos, field, codes, refused):
    with refused(gs.SetupError, "arguments at reference"):
        gs.reconstruct(field, bos, device="cpu")
    with refused(gs.SetupError, "invalid_value at reference", "middle"):
        gs.reconstruct(field, bos, reference="middle", device="cpu")
    with pytest.raises(ValueError, match="method"):
        gs.reconstruct(field, bos, reference="left", method="other")
    with pytest.warns(gs.GladstoneWarning) as caught:
        bare = gs.reconstruct((field.x, field.y, field.u, field.v), bos, reference="left", device="cpu")
    assert "incomplete at correlate.uncertainty" in codes(caught)
    assert np.all(np.isnan(bare.sigma))


def test_xarray(result):
    pytest.importorskip("xarray")
    data = result.to_xarray()
    assert data["density"].dims == ("y", "x") and data["x"].attrs["units"] == "mm"
    assert np.array_equal(data["sigma"].values, result.sigma, equal_nan=True)
    assert set(data) >= {"density", "sigma", "truth", "error", "region", "reference"}


def test_file_is_that_of_the_command(result, program, case, field, tmp_path):
    h5py = pytest.importorskip("h5py")
    place = tmp_path / "case"
    case.save(place)
    field.save(place / "vectors.h5")
    program("reconstruct", place, "-o", tmp_path / "density.h5", "--no-figures", "--budget", *OPTIONS)
    result.save(tmp_path / "saved.h5")
    with h5py.File(tmp_path / "density.h5") as file, h5py.File(tmp_path / "saved.h5") as saved:
        assert set(file) == set(saved)
        for name in file:
            assert np.array_equal(file[name][...], saved[name][...], equal_nan=True), name
            assert file[name].attrs["units"] == saved[name].attrs["units"], name
    with pytest.raises(gs.OutputError):
        result.save("/proc/density.h5")


def test_plot(result):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    assert len(result.plot().axes) >= 8  # four maps with their colour bars
