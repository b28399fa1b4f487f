"""Files of vectors as other programs read them: every value is equal to that of the field."""

import numpy as np
import pytest

import gladstone as gs

NUMBERS = {
    "x_px": "x", "y_px": "y", "u_px": "u", "v_px": "v", "sigma_u_px": "sigma_u", "sigma_v_px": "sigma_v",
    "peak_ratio": "peak_ratio", "status": "status",
}  # fmt: skip


def same(a, b):
    return np.array_equal(np.asarray(a, float), np.asarray(b, float), equal_nan=True)


@pytest.fixture(scope="module")
def field(case):
    """Vectors with an uncertainty, of which one is invalid."""
    settings = {"window": [32, 16], "overlap": 0.5, "uncertainty": "correlation_statistics"}
    measured = gs.correlate(case.a, case.b, device="cpu", **settings)
    assert measured.valid.any() and np.isfinite(measured.sigma_u[measured.valid]).any()
    return measured


def test_hdf5_file_is_read_by_h5py(field, tmp_path):
    h5py = pytest.importorskip("h5py")
    field.save(tmp_path / "vectors.h5")
    with h5py.File(tmp_path / "vectors.h5") as file:
        for name, attribute in NUMBERS.items():
            assert same(file[name][()].ravel(), getattr(field, attribute).ravel()), name
            assert {"units", "description"} <= set(file[name].attrs), name


def test_matlab_file_is_read_by_scipy(field, tmp_path):
    scipy_io = pytest.importorskip("scipy.io")
    field.save(tmp_path / "vectors.mat")
    written = scipy_io.loadmat(tmp_path / "vectors.mat")
    for name, attribute in NUMBERS.items():
        assert same(written[name], getattr(field, attribute)), name


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_netcdf_file_is_the_xarray_data_set(field, tmp_path, engine):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip({"netcdf4": "netCDF4"}.get(engine, engine))
    field.save(tmp_path / "vectors.nc")
    with xarray.open_dataset(tmp_path / "vectors.nc", engine=engine) as written:
        expected = field.to_xarray()
        assert set(written.data_vars) == set(expected.data_vars)
        for name in [*expected.data_vars, "x", "y", "t"]:
            assert written[name].dims == expected[name].dims, name
            assert same(written[name].values, expected[name].values), name
            assert written[name].attrs.get("units") == expected[name].attrs["units"], name


def test_netcdf_file_has_every_column(field, tmp_path):
    h5py = pytest.importorskip("h5py")
    for ending in ("csv", "nc"):
        field.save(tmp_path / f"vectors.{ending}")
    table = np.genfromtxt(tmp_path / "vectors.csv", delimiter=",", names=True)
    with h5py.File(tmp_path / "vectors.nc") as file:
        for column in set(table.dtype.names) - {"x_px", "y_px"}:
            assert same(file[column.removesuffix("_px")][()].ravel(), table[column]), column


def test_netcdf_file_is_valid_for_pivpy(field, tmp_path):
    schema = pytest.importorskip("pivpy.schema")
    xarray = pytest.importorskip("xarray")
    schema.validate(field.to_xarray())
    field.save(tmp_path / "vectors.nc")
    with xarray.open_dataset(tmp_path / "vectors.nc") as written:
        schema.validate(written)
        for name, standard in schema.STANDARD_NAMES.items():
            assert written[name].attrs["standard_name"] == standard
        assert written.attrs["pivpy_schema_version"] == schema.SCHEMA_VERSION
        with pytest.raises(ValueError):
            schema.validate(written.drop_vars("chc"))


# pivpy computes on the file as on a data set of its own: du/dx - dv/dy of a field u = 2 y, v = -x is -3 everywhere.
def test_pivpy_computes_on_the_file(tmp_path):
    pytest.importorskip("pivpy.pivpy")
    xarray = pytest.importorskip("xarray")
    y, x = np.mgrid[0:6, 0:8] * 8.0
    gs.Field(x, y, 2 * y, -x).save(tmp_path / "vectors.nc")
    with xarray.open_dataset(tmp_path / "vectors.nc") as written:
        vorticity = written.load().piv.vec2scal("vorticity")["w"].values
    assert np.allclose(vorticity, -3, rtol=0, atol=1e-12)


def vtk_arrays(reader, path):
    """Reads a file by VTK. Returns its points [N, 3] and its arrays by name."""
    support = pytest.importorskip("vtkmodules.util.numpy_support")
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    arrays = {}
    for holder in (data.GetPointData(), data.GetCellData()):
        for i in range(holder.GetNumberOfArrays()):
            arrays[holder.GetArrayName(i)] = support.vtk_to_numpy(holder.GetArray(i))
    points = np.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])
    return points, arrays


@pytest.mark.parametrize("ending", ["vti", "vtp"])
def test_vtk_file_is_read_by_vtk(field, tmp_path, ending):
    xml = pytest.importorskip("vtkmodules.vtkIOXML")
    field.save(tmp_path / f"vectors.{ending}")
    reader = xml.vtkXMLImageDataReader() if ending == "vti" else xml.vtkXMLPolyDataReader()
    points, arrays = vtk_arrays(reader, tmp_path / f"vectors.{ending}")
    # VTK's origin and spacing of an image are added up in double precision
    assert np.allclose(points[:, 0], field.x.ravel(), rtol=1e-14) and np.allclose(points[:, 1], field.y.ravel(), rtol=1e-14)
    assert same(arrays["displacement_px"][:, 0], field.u.ravel())
    assert same(arrays["displacement_px"][:, 1], field.v.ravel())
    assert same(arrays["sigma_px"][:, 0], field.sigma_u.ravel()) and same(arrays["sigma_px"][:, 1], field.sigma_v.ravel())
    assert same(arrays["peak_ratio"], field.peak_ratio.ravel()) and same(arrays["status"], field.status.ravel())


ALL = ["h5", "csv", "nc", "mat", "dat", "vti", "vtp"]


@pytest.mark.parametrize("ending", ALL)
def test_every_format_is_read_again(field, tmp_path, ending):
    field.save(tmp_path / f"vectors.{ending}")
    again = gs.Field.load(tmp_path / f"vectors.{ending}")
    assert again.shape == field.shape
    for name in NUMBERS.values():
        assert same(getattr(again, name), getattr(field, name)), name


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_data_set_that_xarray_writes_is_read(field, tmp_path, engine):
    pytest.importorskip("xarray")
    pytest.importorskip({"netcdf4": "netCDF4"}.get(engine, engine))
    data = field.to_xarray()
    data.transpose("t", "x", "y").to_netcdf(tmp_path / "turned.nc", engine=engine)
    data[["u", "v", "chc"]].to_netcdf(tmp_path / "few.nc", engine=engine)
    turned, few = (gs.Field.load(tmp_path / name) for name in ("turned.nc", "few.nc"))
    for name in NUMBERS.values():
        assert same(getattr(turned, name), getattr(field, name)), name
    assert same(few.u, field.u) and same(few.valid, field.valid)


def test_truth_is_written_at_pixels_or_dots(case, tmp_path):
    case.truth.save(tmp_path / "truth.nc")
    dense = gs.Field.load(tmp_path / "truth.nc")
    assert same(np.stack([dense.u, dense.v], -1), case.truth.flow("mid"))
    case.truth.save(tmp_path / "dots.vtp")
    dots = gs.Field.load(tmp_path / "dots.vtp")
    assert same(dots.u, case.truth.displacement_px[:, 0]) and same(dots.sigma_v, case.truth.error_px[:, 1])
    case.save(tmp_path / "case")
    found = gs.convert(tmp_path / "case" / "truth.h5", tmp_path / "coarse.vti", spacing_px=8, at="a")
    assert (found["columns"], found["rows"]) == (12, 12)
    assert same(gs.Field.load(tmp_path / "coarse.vti").u, case.truth.flow("a", spacing_px=8)[..., 0])


def test_tecplot_file_has_the_numbers(field, tmp_path):
    field.save(tmp_path / "vectors.dat")
    again = gs.Field.load(tmp_path / "vectors.dat")
    assert same(again.u, field.u) and same(again.v, field.v) and same(again.x, field.x)
