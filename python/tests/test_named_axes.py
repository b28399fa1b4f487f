"""Files as xarray, SciPy and VTK read them: named axes with coordinates, and the values of the result."""

import numpy as np
import pytest

import gladstone as gs

from test_tomography import BLOB

xarray = pytest.importorskip("xarray")
pytest.importorskip("h5netcdf")


@pytest.fixture(scope="module")
def density(case):
    return gs.reconstruct(case.correlate(device="cpu"), case, reference="left", device="cpu")


@pytest.fixture(scope="module")
def volume():
    """Volume of three views of a blob."""
    setups = [gs.Setup.from_dict({**BLOB, "target": {**BLOB["target"], "seed": seed}}) for seed in (1, 2, 3)]
    cases = [setup.render(device="cpu") for setup in setups]
    return gs.tomography(cases, reference=["left", "right"], angles_deg=(0, 60, 120), device="cpu")


def opened(path, group=None):
    """Opens a group and requires that all of its axes have names."""
    with xarray.open_dataset(path, engine="h5netcdf", group=group) as data:
        loaded = data.load()
    unnamed = [name for name in loaded.dims if str(name).startswith("phony")]
    assert not unnamed, (path, group, unnamed)
    return loaded


def same(a, b):
    return np.array_equal(np.asarray(a, float), np.asarray(b, float), equal_nan=True)


def test_density(density, tmp_path):
    density.save(tmp_path / "density.h5")
    data = opened(tmp_path / "density.h5")
    assert data["density_kg_m3"].dims == ("y_mm", "x_mm")
    assert data["gradient_kg_m4"].dims == ("y_mm", "x_mm", "component")
    assert same(data["x_mm"], density.x_mm) and same(data["y_mm"], density.y_mm)
    assert same(data["density_kg_m3"], density.density)


def test_density_is_exported(density, tmp_path):
    for ending in ("nc", "mat", "csv", "vti"):
        density.save(tmp_path / f"density.{ending}")
    expected = density.to_xarray()
    data = opened(tmp_path / "density.nc")
    for name in [*expected.data_vars, "x", "y"]:
        assert data[name].dims == expected[name].dims and same(data[name], expected[name]), name
        assert data[name].attrs["units"] == expected[name].attrs["units"], name
    assert same(data["gradient_y"], density.gradient[..., 1])
    table = np.genfromtxt(tmp_path / "density.csv", delimiter=",", names=True)
    assert same(table["density_kg_m3"], density.density.ravel())
    assert same(table["x_mm"], np.meshgrid(density.x_mm, density.y_mm)[0].ravel())
    matlab = pytest.importorskip("scipy.io").loadmat(tmp_path / "density.mat")
    assert same(matlab["sigma_kg_m3"], density.sigma) and same(matlab["y_mm"][:, 0], density.y_mm)


def test_volume_is_exported(volume, tmp_path):
    result = volume
    for ending in ("h5", "nc", "mat", "vti"):
        result.save(tmp_path / f"volume.{ending}")
    data = opened(tmp_path / "volume.nc")
    assert data["density"].dims == ("z", "y", "x") and same(data["density"], result.density)
    assert opened(tmp_path / "volume.h5")["density_kg_m3"].dims == ("z_mm", "y_mm", "x_mm")
    matlab = pytest.importorskip("scipy.io").loadmat(tmp_path / "volume.mat")
    assert same(matlab["density_kg_m3"], result.density.transpose(2, 1, 0))
    gs.convert(tmp_path / "volume.h5", tmp_path / "again.vti")
    xml = pytest.importorskip("vtkmodules.vtkIOXML")
    support = pytest.importorskip("vtkmodules.util.numpy_support")
    for name in ("volume.vti", "again.vti"):
        reader = xml.vtkXMLImageDataReader()
        reader.SetFileName(str(tmp_path / name))
        reader.Update()
        image = reader.GetOutput()
        assert image.GetDimensions() == result.density.shape[::-1]
        assert np.allclose(image.GetSpacing(), [np.diff(axis)[0] for axis in (result.x_mm, result.y_mm, result.z_mm)])
        assert same(support.vtk_to_numpy(image.GetPointData().GetArray("density_kg_m3")), result.density.ravel())


def test_case_and_comparison(case, tmp_path, program):
    case.save(tmp_path / "case")
    dots = opened(tmp_path / "case" / "truth.h5", "dots")
    assert dots["displacement_px"].dims == ("dot", "component") and dots["flux"].dims == ("dot", "frame")
    field = opened(tmp_path / "case" / "truth.h5", "field")
    assert field["density_kg_m3"].dims == ("y_px", "x_px")
    spacing = float(field["spacing_px"][0])
    assert np.array_equal(field["x_px"], np.arange(field.sizes["x_px"]) * spacing + (spacing - 1) / 2)
    opened(tmp_path / "case" / "truth.h5", "rays")
    vectors = case.correlate(device="cpu")
    vectors.save(tmp_path / "case" / "vectors.h5")
    program("compare", tmp_path / "case", "--no-figures")
    chain = opened(tmp_path / "case" / "comparison.h5", "vectors")
    assert chain["ray_truth_px"].dims == ("vector", "component")
    places = set(zip(vectors.x.ravel(), vectors.y.ravel()))
    assert set(map(tuple, chain["position_px"].values)) <= places


def test_particles(piv, tmp_path):
    piv.render(device="cpu").save(tmp_path / "case")
    particles = opened(tmp_path / "case" / "truth.h5", "particles")
    assert particles["position_m"].dims == ("pulse", "particle", "coordinate")
    assert particles["reference_px"].dims == ("particle", "component")


def test_statistics(case, program, tmp_path):
    case.save(tmp_path / "case")
    frames = [tmp_path / "case" / name for name in ("reference.tif", "flow.tif")]
    for number in (1, 2):
        for letter, frame in zip("AB", frames):
            (tmp_path / f"{letter}_{number}.tif").write_bytes(frame.read_bytes())
    program("correlate", tmp_path / "A_*.tif", tmp_path / "B_*.tif", "-o", f"{tmp_path}/run/", "--no-figures")
    flat = opened(tmp_path / "run" / "statistics.h5")
    grid = opened(tmp_path / "run" / "statistics.h5", "grid")
    assert flat["u_mean_px"].dims == ("vector",) and grid["u_mean_px"].dims == ("y_px", "x_px")
    assert same(grid["uv_px2"].values.ravel(), flat["uv_px2"])
    x, y = np.meshgrid(grid["x_px"], grid["y_px"])
    assert same(x.ravel(), flat["x_px"]) and same(y.ravel(), flat["y_px"])
