#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <numeric>
#include <tuple>

#include "render/base/error.h"
#include "render/files/fields/field_file.h"
#include "render/files/hdf5_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/expect_warning.h"
#include "tests/support/folder_fixture.h"
#include "tests/support/number_bytes.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using FieldFiles = FolderFixture;

std::vector<double> read_all(FieldSource& source) {
  std::vector<double> values(source.grid().size());
  source.read_planes(0, source.grid().nodes[2], values);
  return values;
}

/// Returns the value 100 z + 10 y + x at node (x, y, z), so that any confusion of axes is detected.
std::vector<double> numbered(int nx, int ny, int nz) {
  std::vector<double> values;
  for (int z = 0; z < nz; ++z) {
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) values.push_back(100.0 * z + 10.0 * y + x);
    }
  }
  return values;
}

class JhtdbField : public FolderFixture {
 protected:
  using Shape = std::vector<std::size_t>;

  /// Datasets to be written one after the other.
  struct Dataset {
    std::string name;
    Shape shape;
    std::vector<double> values;
  };
  std::string write(std::vector<Dataset> const& datasets) {
    std::string const path = in_folder("cutout.h5");
    Hdf5Writer writer(path, {"test", 1, "", 0, "cpu"});
    for (auto const& dataset : datasets) {
      writer.write(dataset.name, dataset.values, dataset.shape, "1", "test", "z, y, x");
    }
    writer.close();
    return path;
  }
  static Dataset density(int nx = 4, int ny = 3, int nz = 2) {
    return {"Density_0001", Shape{std::size_t(nz), std::size_t(ny), std::size_t(nx), 1}, numbered(nx, ny, nz)};
  }
  /// Returns coordinates first + i step, rounded to float as in a cut-out.
  static Dataset axis(std::string const& name, int nodes, double first, double step) {
    Dataset dataset{name, {std::size_t(nodes)}, {}};
    for (int i = 0; i < nodes; ++i) dataset.values.push_back(static_cast<float>(first + i * step));
    return dataset;
  }
};

TEST_F(JhtdbField, LayoutWithCoordinatesGivesGridAndValues) {
  auto const source = open_field(
      write({density(), axis("xcoor", 4, 1.0, 0.5), axis("ycoor", 3, -2.0, 0.25), axis("zcoor", 2, 0.0, 2.0)}), "");
  EXPECT_EQ(source->name(), "Density_0001");
  EXPECT_THAT(source->grid().nodes, ElementsAre(4, 3, 2));
  // these steps and origins are exact in binary
  EXPECT_EQ(source->grid().spacing.x, 0.5);
  EXPECT_EQ(source->grid().spacing.y, 0.25);
  EXPECT_EQ(source->grid().spacing.z, 2.0);
  EXPECT_EQ(source->grid().origin.x, 1.0);
  EXPECT_EQ(source->grid().origin.y, -2.0);
  EXPECT_EQ(source->grid().origin.z, 0.0);
  auto const expected = numbered(4, 3, 2);
  auto const values = read_all(*source);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], expected[i]);
  std::vector<double> plane(12);
  source->read_planes(1, 1, plane);
  EXPECT_EQ(plane[1 + 4 * 2], 121.0f);  // node x = 1, y = 2, z = 1
}

/// A cut-out with the given units of the x and y axes.
TEST_F(JhtdbField, UnitsAreThoseOfTheAttributes) {
  auto const with_units = [&](std::string const& x_unit, std::string const& y_unit) {
    std::string const path = in_folder("units.h5");
    Hdf5Writer writer(path, {"test", 1, "", 0, "cpu"});
    Dataset const values = density(4, 3, 1);
    writer.write(values.name, values.values, values.shape, "kg m-3", "test", "z, y, x");
    writer.write("xcoor", axis("xcoor", 4, 0, 0.5).values, {4}, x_unit, "test", "node");
    writer.write("ycoor", axis("ycoor", 3, 0, 0.5).values, {3}, y_unit, "test", "node");
    writer.write("zcoor", axis("zcoor", 1, 0, 0.5).values, {1}, "1", "test", "node");  // a plane has no spacing along z
    writer.close();
    return path;
  };
  auto const source = open_field(with_units("m", "m"), "Density_0001");
  EXPECT_TRUE(source->units().spaced);
  EXPECT_EQ(source->units().length, "m");
  EXPECT_EQ(source->units().values, "kg m-3");
  auto const mixed = open_field(with_units("m", "mm"), "Density_0001");  // lengths are in the unit of the first axis
  EXPECT_EQ(mixed->units().length, "m");
  EXPECT_NEAR(mixed->grid().spacing.x, 0.5, 1e-12);
  EXPECT_NEAR(mixed->grid().spacing.y, 0.5e-3, 1e-12);
  EXPECT_EQ(open_field(with_units("m", "furlong"), "")->units().undefined(),
            "lengths along y are in \"furlong\", which is not a known unit of length");
  EXPECT_EQ(open_field(with_units("degrees_north", "degrees_north"), "")->units().undefined(),
            "lengths are in \"degrees_north\", which is not a known unit of length");
  EXPECT_EQ(open_field(with_units("km", "km"), "")->units().metres(), 1e3);
  auto const partial = open_field(with_units("1", "m"), "Density_0001");
  EXPECT_EQ(partial->units().length, "m");
  EXPECT_EQ(partial->grid().spacing.x, 0.5);
  EXPECT_THAT(partial->notes(), ElementsAre(Warns("assumed", HasSubstr("along x"))));
  EXPECT_FALSE(open_field(write({density()}), "")->units().spaced);
}

TEST_F(JhtdbField, LayoutWithoutCoordinatesHasUnitSpacing) {
  // file of the older client, which contains a field and the parameters of the request
  auto const source = open_field(
      write({{"p00000", {2, 3, 4, 1}, numbered(4, 3, 2)}, {"_size", {4}, {1, 4, 3, 2}}, {"_start", {4}, {0, 0, 0, 0}}}),
      "");
  EXPECT_EQ(source->name(), "p00000");
  EXPECT_EQ(source->grid().spacing.y, 1.0);
  EXPECT_EQ(source->grid().origin.z, 0.0);
  EXPECT_EQ(read_all(*source)[1 + 4 * (2 + 3 * 1)], 121.0f);
}

TEST_F(JhtdbField, PlainRankThreeIsRead) {
  auto const source = open_field(write({{"rho", {2, 3, 4}, numbered(4, 3, 2)}}), "rho");
  EXPECT_THAT(source->grid().nodes, ElementsAre(4, 3, 2));
  EXPECT_EQ(read_all(*source)[23], 123.0f);
}

TEST_F(JhtdbField, RealCutOutIsRead) {
  std::string const folder = GLADSTONE_DATA_DIR "/fields/";
  for (auto const* name : {"hbdt512_kepeak_slice.h5", "hbdt512_late_slice.h5"}) {
    auto const source = open_field(folder + name, "");
    EXPECT_EQ(source->significant_bits(), 24) << "the database's cut-outs are floats";
    EXPECT_EQ(source->name(), "Density_0001");
    EXPECT_THAT(source->grid().nodes, ElementsAre(512, 512, 1));
    // a periodic box of length 2 pi with 512 nodes; coordinates are rounded to float
    EXPECT_NEAR(source->grid().spacing.x * 512, 2.0 * M_PI, 1e-5);
    EXPECT_NEAR(source->grid().spacing.y, source->grid().spacing.x, 1e-8);
    auto const values = read_all(*source);
    // Two fluids of densities 1 and 1.05/0.95 = 1.105 (Atwood number 0.05) mix. The mean density corresponds to equal
    // parts in the whole box, and nearly so in a plane; only the overshoot of the spectral simulation exceeds the two
    // densities.
    EXPECT_NEAR(std::accumulate(values.begin(), values.end(), 0.0) / 262144.0, 1.0526, 0.01);
    EXPECT_GT(*std::min_element(values.begin(), values.end()), 0.99f);
    EXPECT_LT(*std::max_element(values.begin(), values.end()), 1.115f);
  }
}

TEST_F(JhtdbField, FloatCoordinatesOfAFineGridAreUniform) {
  // 2 pi / 4096 is 0.0015; a float near 2 pi has an error of 2.4e-7, or 1.6e-4 of a step, above the tolerance of 1e-4.
  int const nodes = 4096;
  double const step = 2.0 * M_PI / nodes;
  auto const source = open_field(write({density(nodes, 1, 1), axis("xcoor", nodes, 0.0, step)}), "");
  EXPECT_NEAR(source->grid().spacing.x, step, 2.4e-7 / (nodes - 1));
}

TEST_F(JhtdbField, AxesThatAreNotUniformAreResampledAndBackwardOnesTurned) {
  auto stretched = axis("ycoor", 3, 0.0, 1.0);
  stretched.values[1] = 1.00005;  // half of the tolerance, which is 1e-4 of a step
  auto const x = axis("xcoor", 4, 0.0, 1.0), z = axis("zcoor", 2, 0.0, 1.0);
  EXPECT_TRUE(open_field(write({density(), x, stretched, z}), "")->notes().empty());
  stretched.values[1] = 1.001;
  auto const resampled = open_field(write({density(), x, stretched, z}), "");
  ASSERT_EQ(resampled->notes().size(), 1u);
  EXPECT_THAT(resampled->notes()[0], Warns("approximated", AllOf(HasSubstr("0.999 to 1.001"), HasSubstr("4 nodes"))));
  auto const turned = open_field(write({density(), axis("xcoor", 4, 3.0, -1.0)}), "");
  EXPECT_EQ(turned->reading().turned_round, "x");
  EXPECT_EQ(turned->grid().origin.x, 0.0);
  EXPECT_EQ(turned->grid().spacing.x, 1.0);
  EXPECT_THAT(read_all(*turned)[0], 3.0) << "the last node of the file is the first in space";
}

TEST_F(JhtdbField, CoordinatesThatAreNoPlacesAreRefused) {
  auto folded = axis("xcoor", 4, 0.0, 1.0);
  folded.values[2] = 0.5;
  EXPECT_THAT(
      [&] {
        open_field(write({density(), folded}), "");
      },
      ThrowsDataError(ErrorCode::invalid_value, "cutout.h5"));
  folded.values[2] = std::nan("");
  EXPECT_THAT(
      [&] {
        open_field(write({density(), folded}), "");
      },
      ThrowsDataError(ErrorCode::invalid_value, "cutout.h5"));
}

TEST_F(JhtdbField, CoordinatesThatDoNotFitAreRefused) {
  EXPECT_THAT(
      [&] {
        open_field(write({density(), axis("zcoor", 5, 0.0, 1.0)}), "");
      },
      ThrowsDataError(ErrorCode::wrong_shape, "cutout.h5"));
  // zcoor has 3 values, which fits only the middle axis of [2, 3, 4]: x and y may be either of the others
  EXPECT_THAT(
      [&] {
        open_field(write({density(), axis("zcoor", 3, 0.0, 1.0)}), "");
      },
      ThrowsDataError(ErrorCode::undetermined, "cutout.h5", AllOf(HasSubstr("\"xzy\""), HasSubstr("\"yzx\""))));
  auto const named = open_field(write({density(), axis("zcoor", 3, 0.0, 1.0)}), "", 1, "xzy");
  EXPECT_THAT(named->grid().nodes, ElementsAre(2, 4, 3));
}

// x, y and z are given at all nodes, as by numpy's meshgrid: each of them varies along one axis.
TEST_F(JhtdbField, CoordinatesOfAllNodesAreUsed) {
  Dataset x{"x", {2, 3, 4}, {}}, y{"y", {2, 3, 4}, {}}, z{"z", {2, 3, 4}, {}};
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 4; ++i) {
        x.values.push_back(i * 0.5);
        y.values.push_back(1 + j * 0.25);
        z.values.push_back(k * 2.0);
      }
    }
  }
  auto const source = open_field(write({density(), x, y, z}), "");
  EXPECT_EQ(source->grid().spacing, (Vec3d{0.5, 0.25, 2}));
  EXPECT_EQ(source->grid().origin, (Vec3d{0, 1, 0}));
  EXPECT_TRUE(source->units().spaced);
  EXPECT_EQ(source->reading().text(), "[2, 3, 4] is read as z, y, x (by its coordinates)");
  EXPECT_TRUE(source->notes().empty());
  // the dataset "x" varies along the slowest axis, so that the array is [nx, ny, nz]
  std::swap(x.values, z.values);
  auto const turned = open_field(write({density(), x, y, z}), "");
  EXPECT_THAT(turned->grid().nodes, ElementsAre(2, 3, 4));
  EXPECT_EQ(turned->grid().spacing, (Vec3d{2, 0.25, 0.5}));
  EXPECT_THAT(
      [&] {
        open_field(write({density(), x, y, z}), "", 1, "zyx");
      },
      ThrowsDataError(ErrorCode::inconsistent, "cutout.h5"));
  y.values[5] += 0.1;
  EXPECT_THAT(
      [&] {
        open_field(write({density(), x, y, z}), "");
      },
      ThrowsDataError(ErrorCode::unsupported, "cutout.h5"));
}

// MATLAB's [X, Y, Z] = ndgrid(x, y, z) results in arrays [nx, ny, nz], which HDF5 stores as [nz, ny, nx]; the arrays of
// meshgrid are [ny, nx, nz], stored as [nz, nx, ny]. If all axes have the same length, only the coordinates distinguish
// them. A MAT-file begins with a block of 512 bytes that is not HDF5.
TEST_F(JhtdbField, CoordinatesTellMatlabsNdgridFromItsMeshgrid) {
  auto const matlab_file = [&](bool ndgrid, bool with_coordinates) {
    Dataset rho{"rho", {3, 3, 3}, {}}, x{"X", {3, 3, 3}, {}}, y{"Y", {3, 3, 3}, {}}, z{"Z", {3, 3, 3}, {}};
    for (int k = 0; k < 3; ++k) {
      for (int slow = 0; slow < 3; ++slow) {
        for (int fast = 0; fast < 3; ++fast) {
          int const i = ndgrid ? fast : slow, j = ndgrid ? slow : fast;
          x.values.push_back(i * 0.5);
          y.values.push_back(1 + j * 0.25);
          z.values.push_back(k * 2.0);
          rho.values.push_back(100.0 * k + 10.0 * j + i);
        }
      }
    }
    std::string const written = in_folder("written.h5");
    std::string const path =
        in_folder((ndgrid ? "ndgrid" : "meshgrid") + std::string(with_coordinates ? "_xyz" : "") + ".mat");
    Hdf5Writer writer(written, {"test", 1, "", 0, "cpu"});
    std::vector<Dataset> all{rho};
    if (with_coordinates) all.insert(all.end(), {x, y, z});
    for (auto const& dataset : all) {
      writer.write(dataset.name, dataset.values, dataset.shape, "1", "test", "as MATLAB stores it");
      writer.attribute(dataset.name, "MATLAB_class", std::string("double"));
    }
    writer.close();
    std::ifstream content(written, std::ios::binary);
    std::string header = "MATLAB 7.3 MAT-file";
    header.resize(512, ' ');
    std::ofstream(path, std::ios::binary) << header << content.rdbuf();
    return path;
  };
  for (bool const ndgrid : {true, false}) {
    auto const source = open_field(matlab_file(ndgrid, true), "");
    EXPECT_EQ(source->name(), "rho");
    EXPECT_EQ(source->reading().axes, ndgrid ? "zyx" : "zxy");
    EXPECT_EQ(source->reading().by, "by its coordinates");
    EXPECT_EQ(source->grid().spacing, (Vec3d{0.5, 0.25, 2}));
    EXPECT_EQ(source->grid().origin, (Vec3d{0, 1, 0}));
    EXPECT_EQ(read_all(*source), numbered(3, 3, 3)) << ndgrid;
    EXPECT_TRUE(source->notes().empty());
  }
  // Without coordinates the order is ambiguous: an array of ndgrid is assumed, and a warning reports the other order.
  auto const assumed = open_field(matlab_file(true, false), "");
  EXPECT_EQ(read_all(*assumed), numbered(3, 3, 3));
  EXPECT_THAT(assumed->notes(),
              ElementsAre(Warns("assumed", AllOf(HasSubstr("[3, 3, 3]"), HasSubstr("axes = \"zxy\"")))));
  EXPECT_EQ(read_all(*open_field(matlab_file(false, false), "", 1, "zxy")), numbered(3, 3, 3));
}

TEST_F(JhtdbField, PlaneAcrossXAndZHasThoseAxes) {
  auto const source =
      open_field(write({{"rho", {3, 4}, numbered(4, 3, 1)}, axis("x", 4, 0.0, 0.5), axis("z", 3, 0.0, 1.5)}), "");
  EXPECT_EQ(source->reading().text(), "[3, 4] is read as z, x (by the lengths of its coordinates)");
  EXPECT_THAT(source->grid().nodes, ElementsAre(4, 1, 3));
  EXPECT_EQ(source->grid().spacing.x, 0.5);
  EXPECT_EQ(source->grid().spacing.z, 1.5);
}

TEST_F(JhtdbField, CoordinatesThatAreNotUsedAreNamed) {
  auto const geographic = open_field(
      write({density(), axis("lon", 4, 0.0, 0.5), axis("lat", 3, 0.0, 0.5), axis("other", 7, 0.0, 1.0)}), "");
  ASSERT_EQ(geographic->notes().size(), 1u);
  EXPECT_THAT(geographic->notes()[0],
              Warns("assumed", AllOf(HasSubstr("z, y, x"), HasSubstr("\"lat\" [3], \"lon\" [4]"))));
  auto const partial = open_field(write({density(), axis("xcoor", 4, 0.0, 0.5)}), "");
  EXPECT_THAT(partial->notes(), ElementsAre(Warns("assumed", AllOf(HasSubstr("z, y"), HasSubstr("1 mm")))));
  EXPECT_EQ(geographic->units().unspaced, "xyz");
  EXPECT_EQ(partial->units().unspaced, "yz");
}

TEST_F(JhtdbField, CoordinatesOfEdgesMakeCells) {
  auto const source =
      open_field(write({density(), axis("x", 5, 0.0, 0.5), axis("y", 4, 1.0, 0.25), axis("z", 3, 0.0, 2.0)}), "");
  EXPECT_EQ(source->reading().by, "by the lengths of its coordinates; data of cells, at their centres");
  EXPECT_EQ(source->grid().spacing, (Vec3d{0.5, 0.25, 2}));
  EXPECT_EQ(source->grid().origin, (Vec3d{0.25, 1.125, 1}));
  EXPECT_THAT(
      [&] {
        open_field(write({density(), axis("x", 5, 0.0, 0.5), axis("y", 3, 0.0, 0.5), axis("z", 2, 0.0, 2.0)}), "");
      },
      ThrowsDataError(ErrorCode::wrong_shape, "cutout.h5"));
}

// Names of coordinate datasets in a table of docs/file-formats.md, each with its unit.
TEST_F(JhtdbField, CoordinatesAreFoundByEachOfTheirNames) {
  auto const length = [&](std::string const& suffix) {
    return open_field(write({density(), axis("x" + suffix, 4, 0.0, 0.5), axis("y" + suffix, 3, 0.0, 0.5),
                             axis("z" + suffix, 2, 0.0, 0.5)}),
                      "")
        ->units()
        .length;
  };
  for (char const* const suffix : {"coor", "", "_coor"}) EXPECT_EQ(length(suffix), "") << suffix;
  for (char const* const unit : {"mm", "m", "um", "cm"}) EXPECT_EQ(length(std::string("_") + unit), unit);
}

TEST_F(JhtdbField, PackedValuesAreUnpackedAndFillValuesRefused) {
  std::string const path = in_folder("packed.nc");
  auto const packed = [&](std::vector<double> const& values) {
    Hdf5Writer writer(path, {"test", 1, "", 0, "cpu"});
    writer.write("rho", values, {2, 3, 4}, "kg m-3", "test", "z, y, x");
    writer.attribute("rho", "scale_factor", 0.5);
    writer.attribute("rho", "add_offset", 10.0);
    writer.attribute("rho", "_FillValue", std::int64_t{-32767});
    writer.attribute("rho", "missing_value", 1e20);
    writer.close();
    return open_field(path, "");
  };
  auto values = numbered(4, 3, 2);
  auto const read = read_all(*packed(values));
  for (std::size_t i = 0; i < read.size(); ++i) EXPECT_EQ(read[i], 10 + 0.5 * values[i]);
  values[5] = -32767;
  values[6] = static_cast<float>(1e20);  // the value has fewer digits than the attribute
  EXPECT_THAT([&] { read_all(*packed(values)); },
              ThrowsDataError(ErrorCode::invalid_value, "packed.nc", HasSubstr("2 of 24")));
}

/// Writes the attribute of the HDF5 Dimension Scale Specification, as H5DSset_label() does.
void label_axes(std::string const& path, char const* dataset, std::vector<char const*> const& labels) {
  hid_t const file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), object = H5Dopen2(file, dataset, H5P_DEFAULT);
  hid_t const type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  hsize_t const count = labels.size();
  hid_t const space = H5Screate_simple(1, &count, nullptr);
  hid_t const attribute = H5Acreate2(object, "DIMENSION_LABELS", type, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(attribute, type, static_cast<void const*>(labels.data()));
  H5Aclose(attribute);
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(object);
  H5Fclose(file);
}

TEST_F(JhtdbField, DimensionLabelsNameTheAxes) {
  std::string const path = write({{"rho", {2, 3, 4}, numbered(4, 3, 2)}});
  label_axes(path, "rho", {"x", "y", "z"});
  EXPECT_EQ(open_field(path, "")->reading().text(), "[2, 3, 4] is read as x, y, z (by its dimension labels)");
  EXPECT_EQ(open_field(path, "", 1, "zyx")->reading().by, "axes = \"zyx\"");
  write({{"rho", {2, 3, 4}, numbered(4, 3, 2)}});
  label_axes(path, "rho", {"time", "y", "x"});
  EXPECT_EQ(open_field(path, "")->reading().by, "the default order");
}

TEST_F(JhtdbField, ComplexNumbersAreNamed) {
  std::string const path = write({axis("x", 4, 0, 1)});
  hid_t const file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  hid_t const type = H5Tcreate(H5T_COMPOUND, 2 * sizeof(double));
  H5Tinsert(type, "r", 0, H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "i", sizeof(double), H5T_NATIVE_DOUBLE);
  hsize_t const shape[]{2, 3, 4};
  hid_t const space = H5Screate_simple(3, shape, nullptr);
  H5Dclose(H5Dcreate2(file, "rho", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Sclose(space);
  H5Tclose(type);
  H5Fclose(file);
  EXPECT_THAT([&] { open_field(path, ""); }, ThrowsDataError(ErrorCode::missing_content, "cutout.h5"));
  EXPECT_THAT([&] { open_field(path, "rho"); }, ThrowsDataError(ErrorCode::wrong_type, "cutout.h5"));
}

// Every numeric type in either byte order, through every filter of the HDF5 library, with every file name extension.
TEST_F(FieldFiles, EveryNumberOfHdf5IsRead) {
  struct Stored {
    hid_t type;
    int significant_bits;
  };
  std::vector<double> const values = numbered(4, 3, 2);  // values up to 123, which fit into every type
  hsize_t const shape[]{2, 3, 4}, chunk[]{1, 2, 4};
  auto const write = [&](std::string const& name, hid_t type, bool filtered) {
    hid_t const file = H5Fcreate(in_folder(name).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hid_t const space = H5Screate_simple(3, shape, nullptr), creation = H5Pcreate(H5P_DATASET_CREATE);
    if (filtered) {
      H5Pset_chunk(creation, 3, chunk);
      H5Pset_shuffle(creation);
      H5Pset_deflate(creation, 6);
      H5Pset_fletcher32(creation);
    }
    hid_t const dataset = H5Dcreate2(file, "rho", type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(dataset);
    H5Pclose(creation);
    H5Sclose(space);
    H5Fclose(file);
    return open_field(in_folder(name), "");
  };
  for (Stored const& stored :
       {Stored{H5T_IEEE_F32LE, 24}, Stored{H5T_IEEE_F32BE, 24}, Stored{H5T_IEEE_F64LE, 53}, Stored{H5T_IEEE_F64BE, 53},
        Stored{H5T_STD_I8LE, 8}, Stored{H5T_STD_U8LE, 8}, Stored{H5T_STD_I16BE, 16}, Stored{H5T_STD_U16LE, 16},
        Stored{H5T_STD_I32BE, 32}, Stored{H5T_STD_U32LE, 32}, Stored{H5T_STD_I64LE, 64}, Stored{H5T_STD_U64BE, 64}}) {
    for (bool const filtered : {false, true}) {
      auto const source = write("types.h5", stored.type, filtered);
      EXPECT_EQ(read_all(*source), values) << stored.significant_bits << filtered;
      EXPECT_EQ(source->significant_bits(), stored.significant_bits);
    }
  }
  for (char const* const name : {"a.h5", "a.hdf5", "a.he5", "a.nc", "a.mat", "A.H5"})
    EXPECT_EQ(read_all(*write(name, H5T_IEEE_F32LE, false)), values) << name;
}

TEST_F(JhtdbField, HolesAreCountedOverTheWholeField) {
  auto field = density(4, 3, 5);
  field.values[7] = field.values[30] = field.values[59] = -999.9;
  auto const source = open_field(write({field}), "");
  std::vector<double> plane(12);
  EXPECT_NO_THROW(source->read_planes(1, 1, plane));  // nodes 12 to 23 are valid
  EXPECT_THAT([&] { source->read_planes(0, 1, plane); },
              ThrowsDataError(ErrorCode::invalid_value, "cutout.h5", HasSubstr("3 of 60")));
}

TEST_F(JhtdbField, NanAndInfinityAreRefused) {
  auto field = density();
  field.values[3] = std::nan("");
  field.values[4] = std::numeric_limits<double>::infinity();
  field.values[5] = 1e300;  // infinite as a float
  auto const source = open_field(write({field}), "");
  EXPECT_THAT([&] { read_all(*source); }, ThrowsDataError(ErrorCode::invalid_value, "cutout.h5", HasSubstr("3 of 24")));
}

// The index of air differs from 1 by 2.7e-4: the variations that determine the gradient are beyond the seventh digit,
// the last one of a float.
TEST_F(FieldFiles, DoublesKeepAllTheirDigits) {
  std::vector<double> const values{1 + 2.7e-4, 1 + 2.7e-4 + 1e-12, 0.1, -1.0 / 3};
  std::string const h5 = in_folder("n.h5");
  Hdf5Writer writer(h5, {"test", 1, "", 0, "cpu"});
  writer.write("n", values, {1, 2, 2}, "1", "test", "z, y, x");
  writer.close();
  std::string const nrrd = in_folder("n.nrrd");
  std::ofstream(nrrd, std::ios::binary)
      << "NRRD0004\ntype: double\ndimension: 2\nsizes: 2 2\nendian: little\nencoding: raw\n\n"
      << std::string(reinterpret_cast<char const*>(values.data()), sizeof(double) * values.size());
  for (auto const& path : {h5, nrrd}) {
    auto const source = open_field(path, "");
    EXPECT_EQ(read_all(*source), values) << path;
    EXPECT_EQ(source->significant_bits(), 53) << path;
  }
}

TEST_F(JhtdbField, PlainPlaneIsRead) {
  auto const source = open_field(write({{"plane", {3, 4}, numbered(4, 3, 1)}}), "");
  EXPECT_THAT(source->grid().nodes, ElementsAre(4, 3, 1));
  EXPECT_EQ(source->reading().axes, "yx");
  EXPECT_EQ(read_all(*source), numbered(4, 3, 1));
}

TEST_F(JhtdbField, WrongRankNamesTheShape) {
  auto const line = Dataset{"line", {4}, numbered(4, 1, 1)};
  EXPECT_THAT([&] { open_field(write({line}), "line"); }, ThrowsDataError(ErrorCode::wrong_shape, "cutout.h5"));
  auto const velocity = Dataset{"Velocity_0001", {1, 1, 2, 3}, {1, 2, 3, 4, 5, 6}};
  EXPECT_THAT([&] { open_field(write({velocity}), "Velocity_0001"); },
              ThrowsDataError(ErrorCode::wrong_shape, "cutout.h5"));
  auto const first = Dataset{"v", {3, 1, 9, 8}, numbered(8, 9, 3)};
  EXPECT_THAT([&] { open_field(write({first}), "v"); }, ThrowsDataError(ErrorCode::wrong_shape, "cutout.h5"));
  EXPECT_THAT(
      [&] {
        open_field(write({velocity, line}), "");
      },
      ThrowsDataError(ErrorCode::missing_content, "cutout.h5"));
}

// [64, 32, 3] may be a volume with three nodes along x, or a plane of velocities.
TEST_F(JhtdbField, AxisThatMayHoldComponentsIsReported) {
  auto const narrow = Dataset{"v", {16, 12, 3}, numbered(3, 12, 16)};
  auto const source = open_field(write({narrow}), "v");
  ASSERT_EQ(source->notes().size(), 1u);
  EXPECT_THAT(source->notes()[0], Warns("assumed"));
  EXPECT_TRUE(open_field(write({{"v", {16, 12, 9}, numbered(9, 12, 16)}}), "v")->notes().empty());
}

TEST_F(JhtdbField, SeveralFieldsAskForAName) {
  auto second = density();
  second.name = "Density_0002";
  std::string const path = write({density(), second});
  EXPECT_THAT([&] { open_field(path, ""); },
              ThrowsDataError(ErrorCode::undetermined, "cutout.h5", HasSubstr("\"Density_0001\" or \"Density_0002\"")));
  EXPECT_THAT([&] { open_field(path, "Density_001"); },
              ThrowsDataError(ErrorCode::missing_content, "cutout.h5", HasSubstr("\"Density_0001\"")));
}

TEST_F(FieldFiles, UnknownFormatsAndMissingFilesAreNamed) {
  EXPECT_THAT([&] { open_field(in_folder("absent.h5"), ""); }, ThrowsDataError(ErrorCode::missing_file, "absent.h5"));
  std::ofstream(in_folder("field.xyz")) << "x";
  EXPECT_THAT([&] { open_field(in_folder("field.xyz"), ""); }, ThrowsDataError(ErrorCode::unsupported, "field.xyz"));
  std::ofstream(in_folder("field.vtk")) << "x";
  EXPECT_THAT([&] { open_field(in_folder("field.vtk"), ""); }, ThrowsDataError(ErrorCode::wrong_format, "field.vtk"));
  std::ofstream(in_folder("text.H5")) << "x";
  EXPECT_THAT([&] { open_field(in_folder("text.H5"), ""); }, ThrowsDataError(ErrorCode::wrong_format, "text.H5"));
  EXPECT_THAT([&] { open_field(folder_.string(), ""); }, ThrowsDataError(ErrorCode::unreadable_file, ""));
}

class NrrdField : public FolderFixture {
 protected:
  static std::string header(std::string const& fields) { return "NRRD0005\n# a comment\nnote:=ignored\n" + fields; }

  std::string gzipped(std::string const& content) const {
    std::string const path = in_folder("scratch.gz");
    gzFile const file = gzopen(path.c_str(), "wb");
    gzwrite(file, content.data(), static_cast<unsigned>(content.size()));
    gzclose(file);
    return gladstone::content(path);
  }

  void expect_numbered(std::string const& path) const {
    SCOPED_TRACE(path);
    auto const source = open_field(path, "");
    ASSERT_THAT(source->grid().nodes, ElementsAre(4, 3, 2));
    auto const expected = numbered(4, 3, 2);
    auto const values = read_all(*source);
    for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], expected[i]);
  }
};

constexpr char grid_432[] = "dimension: 3\nsizes: 4 3 2\n";

TEST_F(NrrdField, EveryTypeAndByteOrderIsRead) {
  auto const values = numbered(4, 3, 2);  // values up to 123, which fit into every type
  auto const check = [&](std::string const& type, std::string const& little, std::string const& big) {
    for (bool const is_big : {false, true}) {
      std::string const fields = "type: " + type + "\nencoding: raw\nendian: " + (is_big ? "big" : "little") + "\n";
      expect_numbered(write("field.nrrd", header(grid_432 + fields) + "\n" + (is_big ? big : little)));
    }
  };
  check("float", bytes<float>(values), bytes<float>(values, true));
  check("double", bytes<double>(values), bytes<double>(values, true));
  check("int8", bytes<std::int8_t>(values), bytes<std::int8_t>(values, true));
  check("uchar", bytes<std::uint8_t>(values), bytes<std::uint8_t>(values, true));
  check("short", bytes<std::int16_t>(values), bytes<std::int16_t>(values, true));
  check("unsigned short", bytes<std::uint16_t>(values), bytes<std::uint16_t>(values, true));
  check("int", bytes<std::int32_t>(values), bytes<std::int32_t>(values, true));
  check("uint32", bytes<std::uint32_t>(values), bytes<std::uint32_t>(values, true));
  check("long long", bytes<std::int64_t>(values), bytes<std::int64_t>(values, true));
  check("uint64_t", bytes<std::uint64_t>(values), bytes<std::uint64_t>(values, true));
}

TEST_F(NrrdField, AttachedAndDetachedRawAndGzipAreRead) {
  std::string const data = bytes<float>(numbered(4, 3, 2));
  std::string const type = std::string(grid_432) + "type: float\nendian: little\n";
  expect_numbered(write("a.nrrd", header(type + "encoding: raw\n") + "\n" + data));
  expect_numbered(write("b.nrrd", header(type + "encoding: gzip\n") + "\n" + gzipped(data)));
  fs::create_directory(folder_ / "sub");
  write("sub/data.raw", data);
  expect_numbered(write("c.nhdr", header(type + "encoding: raw\ndata file: sub/data.raw\n")));
  write("data.raw.gz", gzipped(data));
  expect_numbered(write("d.nhdr", header(type + "encoding: gz\r\ndatafile: data.raw.gz\r\n")));
}

TEST_F(NrrdField, SkippedLinesAndBytesAreLeftOut) {
  std::string const data = bytes<float>(numbered(4, 3, 2));
  std::string const type = std::string(grid_432) + "type: float\nendian: little\n";
  std::string const raw = type + "encoding: raw\ndata file: data\n";
  write("data", "line one\nline two\nabc" + data + "trailing");
  expect_numbered(write("a.nhdr", header(raw + "line skip: 2\nbyte skip: 3\n")));
  write("data", "whatever stands before" + data);
  expect_numbered(write("b.nhdr", header(raw + "byte skip: -1\n")));
  write("data", "line\n" + gzipped("abc" + data));
  expect_numbered(write("c.nhdr", header(type + "encoding: gzip\ndata file: data\nlineskip: 1\nbyteskip: 3\n")));
}

TEST_F(NrrdField, CompressedPlanesComeInAnyOrder) {
  std::string const content = header(std::string(grid_432) + "type: float\nendian: little\nencoding: gzip\n") + "\n" +
                              gzipped(bytes<float>(numbered(4, 3, 2)));
  auto const source = open_field(write("a.nrrd", content), "");
  std::vector<double> plane(12);
  for (int const z : {1, 0, 1, 1, 0}) {
    source->read_planes(z, 1, plane);
    EXPECT_EQ(plane[5], 100.0f * static_cast<float>(z) + 11.0f);
  }
}

TEST_F(NrrdField, SpacingAndOriginComeFromEitherSpelling) {
  std::string const rest = "type: uint8\nencoding: raw\n\n" + std::string(24, '\1');
  auto const directions = open_field(
      write("a.nrrd", header(std::string(grid_432) +
                             "content: rho\nspace dimension: 3\nspace directions: (0.5,0,0) (0,0.25,0) (0, 0, 2)"
                             "\nspace origin: (1,-2,3)\n" +
                             rest)),
      "");
  EXPECT_EQ(directions->name(), "rho");
  EXPECT_EQ(directions->grid().spacing.x, 0.5);
  EXPECT_EQ(directions->grid().spacing.y, 0.25);
  EXPECT_EQ(directions->grid().spacing.z, 2.0);
  EXPECT_EQ(directions->grid().origin.x, 1.0);
  EXPECT_EQ(directions->grid().origin.y, -2.0);
  EXPECT_EQ(directions->grid().origin.z, 3.0);
  auto const spacings =
      open_field(write("b.nrrd", header(std::string(grid_432) + "spacings: 0.1 0.2 nan\n" + rest)), "");
  EXPECT_EQ(spacings->name(), "b.nrrd");
  EXPECT_EQ(spacings->grid().spacing.y, 0.2);
  EXPECT_EQ(spacings->grid().spacing.z, 1.0);
  EXPECT_EQ(spacings->grid().origin.x, 0.0);
}

TEST_F(NrrdField, UnitsAreThoseOfTheHeader) {
  std::string const rest = "type: uint8\nencoding: raw\n\n" + std::string(24, '\1');
  auto const units = [&](std::string const& lines) {
    return open_field(write("a.nrrd", header(std::string(grid_432) + lines + rest)), "")->units();
  };
  EXPECT_FALSE(units("").spaced);
  EXPECT_EQ(units("").unspaced, "xyz");
  EXPECT_EQ(units("spacings: 1 nan 1\n").unspaced, "y");
  EXPECT_EQ(units("spacings: 1 1 1\n").unspaced, "");
  EXPECT_EQ(units("space dimension: 3\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n").unspaced, "");
  EXPECT_EQ(units("spacings: 1 1 1\n").length, "");
  EXPECT_EQ(units("spacings: 1 1 1\nunits: \"m\" \"m\" \"m\"\nsample units: \"kg/m^3\"\n").length, "m");
  EXPECT_EQ(units("spacings: 1 1 1\nsample units: \"kg/m^3\"\n").values, "kg/m^3");
  EXPECT_EQ(units("space dimension: 3\nspace units: \"um\" \"um\" \"um\"\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n")
                .length,
            "um");
  // lengths are in the unit of the first axis
  auto const mixed = open_field(
      write("b.nrrd", header(std::string(grid_432) + "spacings: 1 1 1\nunits: \"m\" \"mm\" \"m\"\n" + rest)), "");
  EXPECT_EQ(mixed->units().length, "m");
  EXPECT_NEAR(mixed->grid().spacing.y, 1e-3, 1e-15);
  EXPECT_EQ(units("spacings: 1 1 1\nunits: \"m\" \"furlong\" \"m\"\n").undefined(),
            "lengths along y are in \"furlong\", which is not a known unit of length");
  auto const partial = open_field(
      write("c.nrrd", header(std::string(grid_432) + "spacings: 1 1 1\nunits: \"cm\" \"\" \"cm\"\n" + rest)), "");
  EXPECT_EQ(partial->units().length, "cm");
  EXPECT_THAT(partial->notes(), ElementsAre(Warns("assumed", AllOf(HasSubstr("along y"), HasSubstr("cm")))));
}

TEST_F(NrrdField, LabelsNameTheAxes) {
  std::string const rest = "type: uint8\nencoding: raw\n\n" + std::string(24, '\1');
  auto const reading = [&](std::string const& lines, std::string const& axes = "") {
    return open_field(write("a.nrrd", header(std::string(grid_432) + lines + rest)), "", 1, axes)->reading().text();
  };
  EXPECT_EQ(reading("labels: \"z\" \"y\" \"x\"\n"), "[2, 3, 4] is read as x, y, z (by its labels)");
  EXPECT_EQ(reading("labels: \"z\" \"y\" \"x\"\n", "zyx"), "[2, 3, 4] is read as z, y, x (axes = \"zyx\")");
  EXPECT_EQ(reading("labels: \"u\" \"y\" \"x\"\n"), "[2, 3, 4] is read as z, y, x (the default order)");
  EXPECT_EQ(reading("labels: \"x\" \"x\" \"x\"\n"), "[2, 3, 4] is read as z, y, x (the default order)");
}

TEST_F(NrrdField, FieldsGivenTwiceAreRefusedWithTheirLines) {
  std::string const rest = "type: uint8\nencoding: raw\n\n" + std::string(24, '\1');
  std::string const twice =
      write("a.nrrd", header(std::string(grid_432) + "spacings: 1 1 1\nspacings: 2 2 2\n" + rest));
  EXPECT_THAT([&] { open_field(twice, ""); }, ThrowsDataError(ErrorCode::invalid_value, "a.nrrd:7"));
  std::string const same = write("b.nrrd", header(std::string(grid_432) + "spacings: 2 2 2\nspacings: 2 2 2\n" + rest));
  EXPECT_EQ(open_field(same, "")->grid().spacing, (Vec3d{2, 2, 2}));
}

TEST_F(NrrdField, ListOfOneDataFileIsRead) {
  write("a.raw", bytes<float>(numbered(4, 3, 2)));
  std::string const fields =
      std::string(grid_432) + "type: float\nendian: little\nencoding: raw\ndata file: LIST\na.raw\n";
  expect_numbered(write("a.nhdr", header(fields)));
  std::string const several = write("b.nhdr", header(fields + "b.raw\n"));
  EXPECT_THAT([&] { open_field(several, ""); }, ThrowsDataError(ErrorCode::unsupported, "b.nhdr"));
}

TEST_F(NrrdField, TwoDimensionsAreOnePlane) {
  auto const source = open_field(
      write("a.nrrd",
            header("dimension: 2\nsizes: 4 3\nspacings: 0.5 0.5\ntype: float\nendian: little\nencoding: raw\n\n") +
                bytes<float>(numbered(4, 3, 1))),
      "");
  EXPECT_THAT(source->grid().nodes, ElementsAre(4, 3, 1));
  EXPECT_EQ(read_all(*source)[4 * 2 + 1], 21.0f);
}

// The components of a velocity are the fastest axis; axes of length one are ignored at any position.
TEST_F(NrrdField, VelocityHasItsComponentsFastest) {
  std::vector<double> values;
  for (double const value : numbered(4, 3, 2)) values.insert(values.end(), {value, -value, value + 0.5});
  std::string const rest = "type: float\nendian: big\nencoding: raw\n\n" + bytes<float>(values, true);
  for (char const* const sizes : {"dimension: 4\nsizes: 3 4 3 2\nspacings: nan 0.5 0.25 2\n",
                                  "dimension: 5\nsizes: 3 4 3 2 1\nspacings: nan 0.5 0.25 2 nan\n"}) {
    auto const source = open_field(write("v.nrrd", header(sizes + rest)), "", 3);
    EXPECT_THAT(source->grid().nodes, ElementsAre(4, 3, 2)) << sizes;
    EXPECT_EQ(source->grid().spacing, (Vec3d{0.5, 0.25, 2})) << sizes;
    std::vector<double> read(values.size());
    source->read_planes(0, 2, read);
    EXPECT_EQ(read, values) << sizes;
  }
  std::string const scalar = write("s.nrrd", header(std::string(grid_432) + rest));
  EXPECT_THAT([&] { open_field(scalar, "", 3); }, ThrowsDataError(ErrorCode::wrong_shape, "s.nrrd"));
}

TEST_F(NrrdField, AxesOfLengthOneAreIgnored) {
  std::string const rest = "type: float\nendian: little\nencoding: raw\n\n" + bytes<float>(numbered(4, 3, 2));
  for (char const* const sizes : {"4 3 2 1", "1 4 3 2", "4 1 3 2"})
    expect_numbered(write("one.nrrd", header("dimension: 4\nsizes: " + std::string(sizes) + '\n' + rest)));
}

// Negative spacings place the nodes in -x and -y direction from the first one.
TEST_F(NrrdField, NegativeSpacingsRunBackwards) {
  auto const source =
      open_field(write("back.nrrd", header(std::string(grid_432) + "spacings: -0.5 -0.25 2\naxis mins: 1 2 3\n" +
                                           "centers: node node node\ntype: float\nendian: little\nencoding: raw\n\n" +
                                           bytes<float>(numbered(4, 3, 2)))),
                 "");
  EXPECT_EQ(source->reading().turned_round, "xy");
  EXPECT_EQ(source->grid().spacing, (Vec3d{0.5, 0.25, 2}));
  EXPECT_EQ(source->grid().origin, (Vec3d{1 - 3 * 0.5, 2 - 2 * 0.25, 3}));
  auto const values = read_all(*source);
  EXPECT_EQ(values[0], 23) << "x = 3, y = 2 of the file";
  EXPECT_EQ(values[23], 100) << "x = 0, y = 0, z = 1 of the file";
}

TEST_F(NrrdField, TruncatedDataSayHowMuchIsThere) {
  std::string const data = bytes<float>(numbered(4, 3, 2));  // 96 bytes
  std::string const type = std::string(grid_432) + "type: float\nendian: little\n";
  char const* const present_of_needed = "50 bytes of data are present and 96 are needed";
  std::string const raw = write("raw.nrrd", header(type + "encoding: raw\n") + "\n" + data.substr(0, 50));
  EXPECT_THAT([&] { open_field(raw, ""); },
              ThrowsDataError(ErrorCode::damaged, "raw.nrrd", HasSubstr(present_of_needed)));
  // compressed: the stream is complete but too short ...
  std::string const few = write("few.nrrd", header(type + "encoding: gzip\n") + "\n" + gzipped(data.substr(0, 50)));
  EXPECT_THAT([&] { read_all(*open_field(few, "")); },
              ThrowsDataError(ErrorCode::damaged, "few.nrrd", HasSubstr(present_of_needed)));
  // ... or is itself truncated
  std::string const stream = gzipped(data);
  std::string const cut =
      write("cut.nrrd", header(type + "encoding: gzip\n") + "\n" + stream.substr(0, stream.size() - 20));
  EXPECT_THAT([&] { read_all(*open_field(cut, "")); }, ThrowsDataError(ErrorCode::damaged, "cut.nrrd"));
  std::string const none = write("none.nrrd", header(type + "encoding: raw\n"));
  EXPECT_THAT([&] { open_field(none, ""); }, ThrowsDataError(ErrorCode::missing_content, "none.nrrd"));
}

TEST_F(NrrdField, DamagedCompressedDataAreNoticed) {
  std::string stream = gzipped(bytes<float>(numbered(4, 3, 2)));
  stream[stream.size() - 6] ^= 0x55;  // in the checksum
  std::string const path = write(
      "bad.nrrd", header(std::string(grid_432) + "type: float\nendian: little\nencoding: gzip\n") + "\n" + stream);
  EXPECT_THAT([&] { read_all(*open_field(path, "")); }, ThrowsDataError(ErrorCode::damaged, "bad.nrrd"));
  std::string const plain = write(
      "plain.nrrd", header(std::string(grid_432) + "type: uint8\nencoding: gzip\n") + "\n" + std::string(24, 'x'));
  EXPECT_THAT([&] { read_all(*open_field(plain, "")); }, ThrowsDataError(ErrorCode::damaged, "plain.nrrd"));
}

TEST_F(NrrdField, NanAndHolesAreRefused) {
  auto values = numbered(4, 3, 2);
  values[20] = std::nan("");
  values[3] = -999.9;
  std::string const path = write("a.nrrd", header(std::string(grid_432) + "type: float\nendian: big\nencoding: raw\n") +
                                               "\n" + bytes<float>(values, true));
  EXPECT_THAT([&] { read_all(*open_field(path, "")); },
              ThrowsDataError(ErrorCode::invalid_value, "a.nrrd", HasSubstr("1 of 24")));
}

TEST_F(NrrdField, RefusesUnsupportedHeaders) {
  auto const refuses = [&](std::string const& fields, ErrorCode code) {
    std::string const path = write("a.nrrd", header(fields) + "\n" + std::string(24, '\1'));
    EXPECT_THAT([&] { read_all(*open_field(path, "")); }, ThrowsDataError(code, "a.nrrd")) << fields;
  };
  std::string const type = "type: uint8\n", raw = "encoding: raw\n", grid = grid_432;
  refuses(grid + type + "encoding: zrl\n", ErrorCode::unsupported);
  refuses(grid + type + "encoding: ascii\n", ErrorCode::damaged);
  refuses("dimension: 3\nsizes: 400 300 2\n" + type + "encoding: ascii\n", ErrorCode::damaged);
  refuses(grid + type + "encoding: hex\n", ErrorCode::damaged);
  refuses(grid + type + "encoding: bzip2\n", ErrorCode::damaged);
  refuses(grid + type + raw + "data file: LIST\n", ErrorCode::unsupported);
  refuses(grid + type + raw + "data file: slice%03d.raw 1 9 1\n", ErrorCode::unsupported);
  refuses(grid + type + raw + "space directions: (1,0.1,0) (0,1,0) (0,0,1)\n", ErrorCode::unsupported);
  refuses(grid + type + raw + "space directions: (1,0,0) (2,0,0) (0,0,1)\n", ErrorCode::invalid_value);
  refuses(grid + type + raw + "space directions: none (0,1,0) (0,0,1)\n", ErrorCode::wrong_shape);
  refuses(grid + type + raw + "spacings: 1 1\n", ErrorCode::wrong_shape);
  refuses(grid + type + raw + "spacings: 1 0 1\n", ErrorCode::invalid_value);
  refuses(grid + "type: block\n" + raw, ErrorCode::wrong_type);
  refuses(grid + "type: float\n" + raw, ErrorCode::syntax);
  refuses("dimension: 4\nsizes: 3 4 3 2\n" + type + raw, ErrorCode::wrong_shape);
  refuses("dimension: 3\nsizes: 4 -3 2\n" + type + raw, ErrorCode::invalid_value);
  refuses("dimension: 3\nsizes: 3000000000 3 2\n" + type + raw, ErrorCode::out_of_range);
  refuses("dimension: 3\nsizes: 99999999999999999999 3 2\n" + type + raw, ErrorCode::syntax);
  refuses(type + raw + "dimension: 3\n", ErrorCode::missing_content);
  refuses(grid + type, ErrorCode::missing_content);
  refuses("no colon here\n", ErrorCode::syntax);
  std::string const foreign = write("b.nrrd", "PNG\n");
  EXPECT_THAT([&] { open_field(foreign, ""); }, ThrowsDataError(ErrorCode::wrong_format, "b.nrrd"));
  std::string const absent = write("c.nhdr", header(grid + type + raw + "data file: absent.raw\n"));
  EXPECT_THAT([&] { open_field(absent, ""); }, ThrowsDataError(ErrorCode::missing_file, "absent.raw"));
  EXPECT_THAT([&] { open_field(absent, "Density_0001"); }, ThrowsDataError(ErrorCode::missing_content, "c.nhdr"));
}

// In cut-outs of the older client, the three components of a velocity are adjacent.
TEST_F(JhtdbField, VelocityHasThreeValuesAPoint) {
  std::vector<double> values;
  for (double const value : numbered(4, 3, 2)) values.insert(values.end(), {value, -value, value + 0.5});
  std::string const path = write({{"Velocity_0001", {2, 3, 4, 3}, values}, density()});
  auto const source = open_field(path, "", 3);
  EXPECT_EQ(source->name(), "Velocity_0001");
  EXPECT_EQ(source->values(), 3);
  std::vector<double> plane(36);
  source->read_planes(1, 1, plane);
  EXPECT_TRUE(std::equal(plane.begin(), plane.end(), values.begin() + 36));
  EXPECT_THAT([&] { open_field(path, "Density_0001", 3); }, ThrowsDataError(ErrorCode::wrong_shape, "cutout.h5"));
  EXPECT_THAT([&] { open_field(write({density()}), "", 3); }, ThrowsDataError(ErrorCode::missing_content, "cutout.h5"));
}

// Other programs store the components of a velocity one after the other, [3, nz, ny, nx] or, for a plane, [3, ny, nx].
TEST_F(JhtdbField, VelocityMayHaveItsComponentsFirst) {
  std::vector<double> stored, expected;
  for (auto const component :
       {+[](double v) { return v; }, +[](double v) { return -v; }, +[](double v) { return v + 0.5; }}) {
    for (double const value : numbered(4, 3, 2)) stored.push_back(component(value));
  }
  for (double const value : numbered(4, 3, 2)) expected.insert(expected.end(), {value, -value, value + 0.5});
  std::string const path = write({{"u", {3, 2, 3, 4}, stored}, axis("x", 4, 0.0, 0.5)});
  auto const source = open_field(path, "", 3);
  EXPECT_EQ(source->name(), "u");
  EXPECT_THAT(source->grid().nodes, ElementsAre(4, 3, 2));
  EXPECT_EQ(source->grid().spacing.x, 0.5);
  EXPECT_EQ(source->reading().text(), "[2, 3, 4] is read as z, y, x (the default order)");
  std::vector<double> all(72), row(12);
  source->read_planes(0, 2, all);
  EXPECT_EQ(all, expected);
  source->read_rows(1, 2, 1, row);
  EXPECT_TRUE(std::equal(row.begin(), row.end(), expected.begin() + 60)) << "the last row alone";

  // with the axes in another order, the components remain u, v, w
  auto const exchanged = open_field(write({{"u", {3, 2, 3, 4}, stored}}), "", 3, "xyz");
  EXPECT_THAT(exchanged->grid().nodes, ElementsAre(2, 3, 4));
  exchanged->read_planes(0, 4, all);
  for (std::size_t z = 0; z < 4; ++z) {
    for (std::size_t y = 0; y < 3; ++y) {
      for (std::size_t x = 0; x < 2; ++x) {
        for (std::size_t k = 0; k < 3; ++k)
          ASSERT_EQ(all[((z * 3 + y) * 2 + x) * 3 + k], expected[((x * 3 + y) * 4 + z) * 3 + k]);
      }
    }
  }

  std::vector<double> const plane_stored(stored.begin(), stored.begin() + 36);
  auto const plane = open_field(write({{"u", {3, 3, 4}, plane_stored}}), "", 3);
  EXPECT_THAT(plane->grid().nodes, ElementsAre(4, 3, 1));
  std::vector<double> values(36);
  plane->read_planes(0, 1, values);
  for (std::size_t node = 0; node < 12; ++node) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(values[3 * node + k], plane_stored[12 * k + node]);
  }
}

/// Files written by VTK 9.7 in all of its encodings: a velocity (v, -v, v + 0.5) and a density v, v = 100 z + 10 y + x,
/// on 4 x 3 x 2 nodes whose first index along x is 1.
std::string vtk_file(std::string const& name) {
  return std::string(GLADSTONE_DATA_DIR) + "/../tests/fuzz/corpus/vti_field/" + name;
}

TEST(VtiField, IsReadInEachOfVtksWays) {
  auto const expected = numbered(4, 3, 2);
  for (char const* const name : {"ascii.vti", "binary.vti", "binary_blocks.vti", "appended_base64.vti",
                                 "appended_raw.vti", "appended_raw_big_endian.vti"}) {
    auto const velocity = open_field(vtk_file(name), "", 3);
    EXPECT_EQ(velocity->name(), "velocity");
    EXPECT_THAT(velocity->grid().nodes, ElementsAre(4, 3, 2));
    EXPECT_EQ(velocity->grid().spacing, (Vec3d{0.5, 0.25, 2}));
    EXPECT_EQ(velocity->grid().origin, (Vec3d{1, -1, 3}));
    EXPECT_EQ(velocity->significant_bits(), 24);
    std::vector<double> values(3 * expected.size());
    velocity->read_planes(0, 2, values);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(values[3 * i], expected[i]) << name;
      EXPECT_EQ(values[3 * i + 1], -expected[i]) << name;
      EXPECT_EQ(values[3 * i + 2], expected[i] + 0.5) << name;
    }
    auto const density = open_field(vtk_file(name), "density");
    EXPECT_EQ(read_all(*density), expected) << name;
  }
}

class VtiFiles : public FolderFixture {
 protected:
  /// Writes a file with the given text and reads it.
  void read(std::string const& text, std::string const& dataset = "", int values = 1) {
    std::ofstream(in_folder("field.vti")) << text;
    auto const source = open_field(in_folder("field.vti"), dataset, values);
    std::vector<double> all(source->grid().size() * static_cast<std::size_t>(values));
    source->read_planes(0, source->grid().nodes[2], all);
  }
  static std::string image(std::string const& arrays, std::string const& grid = "WholeExtent=\"0 1 0 1 0 0\"") {
    return "<?xml version=\"1.0\"?><VTKFile type=\"ImageData\"><ImageData " + grid +
           "><Piece Extent=\"0 1 0 1 0 0\"><PointData>" + arrays + "</PointData></Piece></ImageData></VTKFile>";
  }
  static std::string array(std::string const& keys, std::string const& data) {
    return "<DataArray type=\"Float32\" " + keys + ">" + data + "</DataArray>";
  }
};

// ParaView marks duplicate and hidden points by an additional array of this name.
TEST_F(VtiFiles, ArraysThatMarkGhostsAreNoFields) {
  std::string const good = array("Name=\"a\" format=\"ascii\"", "1 2 3 4");
  std::string const ghosts = "<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">0 0 0 0</DataArray>";
  EXPECT_NO_THROW(read(image(good + ghosts)));
  EXPECT_NO_THROW(read(image(ghosts + good)));
  std::ofstream(in_folder("field.vtk")) << "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET STRUCTURED_POINTS\n"
                                           "DIMENSIONS 2 2 1\nPOINT_DATA 4\nSCALARS vtkGhostType unsigned_char 1\n"
                                           "LOOKUP_TABLE default\n0 0 0 0\nSCALARS a float 1\nLOOKUP_TABLE default\n"
                                           "1 2 3 4\n";
  auto const legacy = open_field(in_folder("field.vtk"), "");
  EXPECT_EQ(legacy->name(), "a");
  EXPECT_THAT(read_all(*legacy), ElementsAre(1, 2, 3, 4));
}

/// Encodes bytes as base64 with padding (RFC 4648).
std::string base64(std::string const& data) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < data.size(); at += 3) {
    unsigned group = 0;
    for (std::size_t i = 0; i < 3; ++i)
      group = group << 8 | (at + i < data.size() ? static_cast<unsigned char>(data[at + i]) : 0u);
    for (std::size_t i = 0; i < 4; ++i) text += i <= data.size() - at ? digits[group >> (18 - 6 * i) & 63u] : '=';
  }
  return text;
}

/// A VTK image of 4 x 3 x 2 points whose indices start at 0. @param keys  additional attributes of the file
std::string vtk_image(std::string const& keys, std::string const& arrays, std::string const& appended = "") {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" " + keys +
         "><ImageData WholeExtent=\"0 3 0 2 0 1\" Origin=\"1 -1 3\" Spacing=\"0.5 0.25 2\">"
         "<Piece Extent=\"0 3 0 2 0 1\"><PointData>" +
         arrays + "</PointData></Piece></ImageData>" + appended + "</VTKFile>\n";
}

// Compressed data (zlib) are preceded by a header of 8-byte integers (header_type UInt64): the number of blocks, the
// size of a block, the size of the last block if it is smaller, and the compressed size of each block. 24 floats are
// two blocks of 40 bytes and one of 16. In base64, the header and the blocks are encoded separately.
TEST_F(VtiFiles, CompressedDataHaveLengthsOfFourOrEightBytes) {
  std::string const path = in_folder("packed.vti");
  for (bool const wide : {true, false}) {
    for (bool const big_endian : {false, true}) {
      std::string const raw = bytes<float>(numbered(4, 3, 2), big_endian);
      std::string blocks;
      std::vector<double> lengths{3, 40, 16};
      for (std::size_t at = 0; at < raw.size(); at += 40) {
        std::string const block = raw.substr(at, 40);
        uLongf size = compressBound(block.size());
        std::string packed(size, '\0');
        ASSERT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<Bytef const*>(block.data()),
                           block.size()),
                  Z_OK);
        lengths.push_back(static_cast<double>(size));
        blocks += packed.substr(0, size);
      }
      std::string const header =
          wide ? bytes<std::uint64_t>(lengths, big_endian) : bytes<std::uint32_t>(lengths, big_endian);
      std::string const keys = std::string("compressor=\"vtkZLibDataCompressor\" header_type=\"") +
                               (wide ? "UInt64" : "UInt32") + "\" byte_order=\"" +
                               (big_endian ? "BigEndian" : "LittleEndian") + '"';
      std::string const encoded = base64(header) + base64(blocks);
      auto const appended = [](std::string const& encoding, std::string const& data) {
        return "<AppendedData encoding=\"" + encoding + "\">_AAAA" + data + "</AppendedData>";
      };
      std::string const at_four = array("Name=\"rho\" format=\"appended\" offset=\"4\"", "");
      for (std::string const& text : {vtk_image(keys, array("Name=\"rho\" format=\"binary\"", encoded)),
                                      vtk_image(keys, at_four, appended("base64", encoded)),
                                      vtk_image(keys, at_four, appended("raw", header + blocks))}) {
        std::ofstream(path, std::ios::binary) << text;
        auto const source = open_field(path, "");
        EXPECT_EQ(read_all(*source), numbered(4, 3, 2)) << wide << big_endian << text;
        EXPECT_TRUE(source->notes().empty());
      }
      // a header with integers of the other width must be reported as damage, not be read as other numbers
      std::string const other = wide ? "UInt32" : "UInt64";
      std::string wrong = vtk_image(keys, at_four, appended("raw", header + blocks));
      wrong.replace(wrong.find("header_type") + 13, 6, other);
      std::ofstream(path, std::ios::binary) << wrong;
      EXPECT_THAT([&] { read_all(*open_field(path, "")); }, ThrowsDataError(ErrorCode::damaged, "packed.vti"));
    }
  }
}

// Every numeric type, as raw bytes in base64, preceded by their length.
TEST_F(VtiFiles, EveryTypeOfNumberIsRead) {
  std::string const path = in_folder("types.vti");
  auto const values = numbered(4, 3, 2);  // values up to 123, which fit into every type
  auto const expect_read = [&](std::string const& type, std::string const& raw, int significant_bits) {
    std::string const length = bytes<std::uint32_t>({static_cast<double>(raw.size())});
    std::ofstream(path, std::ios::binary) << vtk_image(
        "byte_order=\"LittleEndian\" header_type=\"UInt32\"",
        "<DataArray type=\"" + type + "\" Name=\"rho\" format=\"binary\">" + base64(length + raw) + "</DataArray>");
    auto const source = open_field(path, "");
    EXPECT_EQ(read_all(*source), values) << type;
    EXPECT_EQ(source->significant_bits(), significant_bits) << type;
  };
  expect_read("Float32", bytes<float>(values), 24);
  expect_read("Float64", bytes<double>(values), 53);
  expect_read("Int8", bytes<std::int8_t>(values), 7);
  expect_read("UInt8", bytes<std::uint8_t>(values), 8);
  expect_read("Int16", bytes<std::int16_t>(values), 15);
  expect_read("UInt16", bytes<std::uint16_t>(values), 16);
  expect_read("Int32", bytes<std::int32_t>(values), 31);
  expect_read("UInt32", bytes<std::uint32_t>(values), 32);
  expect_read("Int64", bytes<std::int64_t>(values), 63);
  expect_read("UInt64", bytes<std::uint64_t>(values), 64);
  std::ofstream(path) << vtk_image("", "<DataArray type=\"String\" Name=\"rho\" format=\"ascii\">1</DataArray>");
  EXPECT_THAT([&] { open_field(path, ""); }, ThrowsDataError(ErrorCode::wrong_type, "types.vti"));
}

/// A legacy file of 4 x 3 x 2 points. @param data  content from POINT_DATA or CELL_DATA on
std::string legacy_image(std::string const& encoding, std::string const& data) {
  return "# vtk DataFile Version 3.0\ntitle\n" + encoding +
         "\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 3 2\nORIGIN 1 -1 3\nSPACING 0.5 0.25 2\n" + data;
}

// Legacy files use C's names of types; binary numbers are big-endian.
TEST_F(VtiFiles, LegacyFilesHaveEveryTypeOfNumber) {
  std::string const path = in_folder("types.vtk");
  auto const values = numbered(4, 3, 2);
  auto const expect_read = [&](std::string const& type, std::string const& raw) {
    std::ofstream(path, std::ios::binary)
        << legacy_image("BINARY", "POINT_DATA 24\nSCALARS rho " + type + "\nLOOKUP_TABLE default\n" + raw + '\n');
    EXPECT_EQ(read_all(*open_field(path, "")), values) << type;
  };
  expect_read("float", bytes<float>(values, true));
  expect_read("double", bytes<double>(values, true));
  for (char const* const type : {"char", "signed_char", "unsigned_char"})
    expect_read(type, bytes<std::int8_t>(values, true));
  for (char const* const type : {"short", "unsigned_short"}) expect_read(type, bytes<std::int16_t>(values, true));
  for (char const* const type : {"int", "unsigned_int"}) expect_read(type, bytes<std::int32_t>(values, true));
  for (char const* const type : {"long", "unsigned_long", "vtktypeint64", "vtktypeuint64"})
    expect_read(type, bytes<std::int64_t>(values, true));
}

// VTK writes indices (vtkIdType) with 4 bytes (vtkDataWriter), although they have 8 bytes in memory. The field after an
// array of indices must be read at the right position.
TEST_F(VtiFiles, LegacyIndicesHaveFourBytes) {
  auto const values = numbered(4, 3, 2);
  std::string const path = in_folder("indices.vtk");
  std::ofstream(path, std::ios::binary) << legacy_image(
      "BINARY", "POINT_DATA 24\nFIELD FieldData 2\nvtkOriginalPointIds 1 24 vtkIdType\n" +
                    bytes<std::int32_t>(values, true) + "\nrho 1 24 float\n" + bytes<float>(values, true) + '\n');
  EXPECT_EQ(read_all(*open_field(path, "rho")), values);
  EXPECT_EQ(read_all(*open_field(path, "vtkOriginalPointIds")), values);
}

// A velocity as VECTORS and as an array of three components in a FIELD, and data of 3 x 2 x 1 cells at their centres.
TEST_F(VtiFiles, LegacyFilesHaveVelocitiesAndCells) {
  std::vector<double> velocity;
  for (double const value : numbered(4, 3, 2)) velocity.insert(velocity.end(), {value, -value, value + 0.5});
  std::string text;
  for (double const value : velocity) text += std::to_string(value) + ' ';
  std::string const path = in_folder("legacy.vtk");
  for (std::string const& file :
       {legacy_image("ASCII", "POINT_DATA 24\nVECTORS u float\n" + text + '\n'),
        legacy_image("BINARY", "POINT_DATA 24\nVECTORS u float\n" + bytes<float>(velocity, true) + '\n'),
        legacy_image("BINARY",
                     "POINT_DATA 24\nFIELD FieldData 1\nu 3 24 double\n" + bytes<double>(velocity, true) + '\n')}) {
    std::ofstream(path, std::ios::binary) << file;
    auto const source = open_field(path, "", 3);
    EXPECT_EQ(source->name(), "u");
    std::vector<double> read(velocity.size());
    source->read_planes(0, 2, read);
    EXPECT_EQ(read, velocity) << file;
  }
  std::ofstream(path) << legacy_image("ASCII",
                                      "CELL_DATA 6\nSCALARS rho float\nLOOKUP_TABLE default\n0 1 2 10 11 12\n");
  auto const cells = open_field(path, "");
  EXPECT_THAT(cells->grid().nodes, ElementsAre(3, 2, 1));
  EXPECT_EQ(cells->grid().origin, (Vec3d{1.25, -0.875, 4}));
  EXPECT_EQ(read_all(*cells), numbered(3, 2, 1));
}

// i is along y and j along x: the columns of the Direction matrix are the directions of i, j and k. The key "axes"
// overrides it, as it does for any other VTK file.
TEST_F(VtiFiles, DirectionAndTheKeyOrderTheAxes) {
  std::string values;
  for (double const value : numbered(4, 3, 2)) values += std::to_string(value) + ' ';
  std::string const turned =
      "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 3 0 2 0 1\" Spacing=\"0.5 0.25 2\" Direction=\"0 1 0 1 0 "
      "0 0 0 "
      "1\"><Piece Extent=\"0 3 0 2 0 1\"><PointData>" +
      array("Name=\"rho\" format=\"ascii\"", values) + "</PointData></Piece></ImageData></VTKFile>";
  std::ofstream(in_folder("turned.vti")) << turned;
  std::ofstream(in_folder("plain.vti")) << vtk_image("", array("Name=\"rho\" format=\"ascii\"", values));
  std::ofstream(in_folder("plain.vtk")) << legacy_image(
      "ASCII", "POINT_DATA 24\nSCALARS rho float\nLOOKUP_TABLE default\n" + values + '\n');
  for (auto const& [file, axes, by] :
       {std::tuple{"turned.vti", "", "by its Direction"}, std::tuple{"turned.vti", "zxy", "axes = \"zxy\""},
        std::tuple{"plain.vti", "zxy", "axes = \"zxy\""}, std::tuple{"plain.vtk", "zxy", "axes = \"zxy\""}}) {
    auto const source = open_field(in_folder(file), "", 1, axes);
    EXPECT_EQ(source->reading().text(), std::string("[2, 3, 4] is read as z, x, y (") + by + ')') << file;
    EXPECT_THAT(source->grid().nodes, ElementsAre(3, 4, 2)) << file;
    EXPECT_EQ(source->grid().spacing, (Vec3d{0.25, 0.5, 2})) << file;
    EXPECT_EQ(read_all(*source)[1 + 3 * (2 + 4 * 1)], 112) << file << ": x = 1 is j, y = 2 is i, z = 1 is k";
  }
}

/// Expects the coordinates 0, 0.5, 1, 1.5 along x, 1, 1.25, 1.5 along y and -1, 1 along z.
void expect_rectilinear(std::string const& path) {
  auto const source = open_field(path, "");
  EXPECT_THAT(source->grid().nodes, ElementsAre(4, 3, 2));
  EXPECT_EQ(source->grid().spacing, (Vec3d{0.5, 0.25, 2}));
  EXPECT_EQ(source->grid().origin, (Vec3d{0, 1, -1}));
  EXPECT_EQ(source->reading().text(), "[2, 3, 4] is read as z, y, x (as VTK defines it)");
  EXPECT_EQ(read_all(*source), numbered(4, 3, 2));
}

TEST_F(VtiFiles, RectilinearGridsAreReadAsXmlAndInTheLegacyFormat) {
  std::string values;
  for (double const value : numbered(4, 3, 2)) values += std::to_string(value) + ' ';
  std::ofstream(in_folder("field.vtr"))
      << "<VTKFile type=\"RectilinearGrid\"><RectilinearGrid WholeExtent=\"0 3 0 2 0 1\"><Piece Extent=\"0 3 0 2 0 1\">"
         "<PointData>" +
             array("Name=\"rho\" format=\"ascii\"", values) + "</PointData><Coordinates>" +
             array("Name=\"x\" format=\"ascii\"", "0 0.5 1 1.5") + array("Name=\"y\" format=\"ascii\"", "1 1.25 1.5") +
             array("Name=\"z\" format=\"ascii\"", "-1 1") + "</Coordinates></Piece></RectilinearGrid></VTKFile>";
  expect_rectilinear(in_folder("field.vtr"));
  std::ofstream(in_folder("field.vtk"))
      << "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET RECTILINEAR_GRID\n"
         "DIMENSIONS 4 3 2\nX_COORDINATES 4 float\n0 0.5 1 1.5\nY_COORDINATES 3 float\n"
         "1 1.25 1.5\nZ_COORDINATES 2 float\n-1 1\nPOINT_DATA 24\nSCALARS rho float\n"
         "LOOKUP_TABLE default\n" +
             values + '\n';
  expect_rectilinear(in_folder("field.vtk"));
}

// The coordinates along x may descend, those along y may be non-uniform, and data may belong to the 3 x 2 x 1 cells.
TEST_F(VtiFiles, RectilinearGridsMayDescendStretchAndHaveCells) {
  auto const grid = [&](std::string const& x, std::string const& y, std::string const& data) {
    std::ofstream(in_folder("field.vtr"))
        << "<VTKFile type=\"RectilinearGrid\"><RectilinearGrid WholeExtent=\"0 3 0 2 0 1\"><Piece Extent=\"0 3 0 2 0 "
           "1\">" +
               data + "<Coordinates>" + array("Name=\"x\" format=\"ascii\"", x) +
               array("Name=\"y\" format=\"ascii\"", y) + array("Name=\"z\" format=\"ascii\"", "-1 1") +
               "</Coordinates></Piece></RectilinearGrid></VTKFile>";
    return open_field(in_folder("field.vtr"), "");
  };
  std::string values;
  for (double const value : numbered(4, 3, 2)) values += std::to_string(value) + ' ';
  std::string const points = "<PointData>" + array("Name=\"rho\" format=\"ascii\"", values) + "</PointData>";
  auto const descending = grid("1.5 1 0.5 0", "1 1.25 1.5", points);
  EXPECT_EQ(descending->reading().turned_round, "x");
  EXPECT_EQ(descending->grid().spacing.x, 0.5);
  EXPECT_EQ(descending->grid().origin.x, 0);
  EXPECT_EQ(read_all(*descending).front(), 3);

  // Coordinates 0, 1, 3 are resampled to the finest spacing, that is, four nodes; the values 10 j are not linear in y.
  auto const stretched = grid("0 0.5 1 1.5", "0 1 3", points);
  EXPECT_THAT(stretched->grid().nodes, ElementsAre(4, 4, 2));
  EXPECT_THAT(stretched->notes(), ElementsAre(Warns("approximated", HasSubstr(": y"))));

  auto const cells = grid("0 0.5 1 1.5", "1 1.25 1.5",
                          "<CellData>" + array("Name=\"rho\" format=\"ascii\"", "0 1 2 10 11 12") + "</CellData>");
  EXPECT_THAT(cells->grid().nodes, ElementsAre(3, 2, 1));
  EXPECT_EQ(cells->grid().origin, (Vec3d{0.25, 1.125, 0}));
  EXPECT_EQ(cells->grid().spacing.x, 0.5);
  EXPECT_EQ(cells->grid().spacing.y, 0.25);
  EXPECT_EQ(cells->reading().by, "as VTK defines it; data of cells, at their centres");
  EXPECT_EQ(read_all(*cells), numbered(3, 2, 1));
}

TEST_F(VtiFiles, RefusesWhatItCannotRead) {
  auto const refuses = [this](std::string const& text, ErrorCode code, std::string const& dataset = "") {
    EXPECT_THAT(([&] { read(text, dataset); }), ThrowsDataError(code, "field.vti")) << text;
  };
  std::string const good = array("Name=\"a\" format=\"ascii\"", "1 2 3 4");
  EXPECT_NO_THROW(read(image(good)));
  refuses("", ErrorCode::wrong_format);
  refuses("<VTKFile type=\"ImageData\">", ErrorCode::damaged);
  refuses("<VTKFile type=\"UnstructuredGrid\"></VTKFile>", ErrorCode::unsupported);
  refuses(image(""), ErrorCode::missing_content);
  refuses(image(good), ErrorCode::missing_content, "b");
  refuses(image(good + array("Name=\"b\"", "1 2 3 4")), ErrorCode::undetermined);
  refuses(image(array("Name=\"a\" NumberOfComponents=\"2\"", "1 2")), ErrorCode::wrong_shape, "a");
  refuses(image(good, "WholeExtent=\"0 2 0 1 0 0\""), ErrorCode::missing_content);
  refuses(image(good, "WholeExtent=\"0 1 0 1\""), ErrorCode::syntax);
  refuses(image(good, "WholeExtent=\"0 1 0 1 0 0\" Spacing=\"1 0 1\""), ErrorCode::invalid_value);
  refuses(image(good, "WholeExtent=\"0 1 0 1 0 0\" Direction=\"0.6 0.8 0 -0.8 0.6 0 0 0 1\""), ErrorCode::unsupported);
  refuses(image(array("Name=\"a\" format=\"ascii\"", "1 2 3")), ErrorCode::damaged);
  refuses(image(array("Name=\"a\" format=\"ascii\"", "1 2 nan 3")), ErrorCode::invalid_value);
  refuses(image(array("Name=\"a\" format=\"binary\"", "AAAA")), ErrorCode::damaged);
  refuses(image(array("Name=\"a\" format=\"binary\"", "EAAAAAAAAAAAAAAA?AAAAAAAAAA=")), ErrorCode::damaged);
  refuses(image(array("Name=\"a\" format=\"binary\"", "DAAAAAAAAAAAAAAAAAAAAAAAAAA=")), ErrorCode::damaged);
  refuses(image(array("Name=\"a\" format=\"appended\" offset=\"0\"", "")), ErrorCode::damaged);
  refuses("<VTKFile type=\"ImageData\" compressor=\"vtkOtherCompressor\"></VTKFile>", ErrorCode::unsupported);
}

}  // namespace
}  // namespace gladstone
