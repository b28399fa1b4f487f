#include "render/scene/field_coverage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "render/files/hdf5_file.h"
#include "tests/scene/small_scenes.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

Bounds<double> box(double width, double height, Vec2d centre = {}) {
  return {{centre.x - width / 2, centre.y - height / 2, -5e-3}, {centre.x + width / 2, centre.y + height / 2, 5e-3}};
}

// Table 1 with 512 px of 10 um: M = 0.117318, so that the view is 43.642 mm wide at the dots, and Z_A / Z_B of that,
// 32.732 mm, at the mid-plane, which chief rays cross at a quarter of the distance to the lens.
TEST(FieldCoverage, IsTheShareOfTheViewAtTheField) {
  FieldCoverage const seen = field_coverage(box(10e-3, 20e-3), table1_setup(512));
  EXPECT_NEAR(seen.view.x, 32.732e-3, 1e-6);
  EXPECT_NEAR(seen.share, 10e-3 * 20e-3 / (seen.view.x * seen.view.y), 1e-12);
  EXPECT_NEAR(seen.ratio, 20e-3 / seen.view.y, 1e-12);
  EXPECT_FALSE(seen.warning());
  // half of the field is outside the view
  FieldCoverage const beside = field_coverage(box(10e-3, 20e-3, {seen.view.x / 2, 0}), table1_setup(512));
  EXPECT_NEAR(beside.share, seen.share / 2, 1e-12);
}

TEST(FieldCoverage, WarnsOfAFieldThatFillsLittle) {
  EXPECT_THAT(field_coverage(box(9e-3, 11e-3), table1_setup(512)).warning(),
              Optional(Warns("implausible at medium.field", AllOf(HasSubstr("9.2 %"), HasSubstr("32.73 x 32.73 mm")))));
  EXPECT_THAT(field_coverage(box(32e-3, 32e-3, {0.1, 0}), table1_setup(512)).warning(),
              Optional(Warns("implausible at medium.field", HasSubstr(" 0 %"))));
}

// Lengths in metres or micrometres that are read as millimetres.
TEST(FieldCoverage, NamesTheUnitThatWouldFit) {
  EXPECT_THAT(field_coverage(box(32e-6, 32e-6), table1_setup(512)).warning(),
              Optional(Warns("implausible at medium.field", AllOf(HasSubstr("metres"), HasSubstr("32 x 32 mm")))));
  EXPECT_THAT(field_coverage(box(32, 32), table1_setup(512)).warning(),
              Optional(Warns("implausible at medium.field", AllOf(HasSubstr(" um"), HasSubstr("32 x 32 mm")))));
  EXPECT_FALSE(field_coverage(box(1, 1), table1_setup(512)).warning()) << "a large field is plausible";
}

TEST(FieldCoverage, IsCompleteForUnboundedFields) {
  FieldCoverage const slab =
      field_coverage({{-unbounded, -unbounded, -5e-3}, {unbounded, unbounded, 5e-3}}, table1_setup(512));
  EXPECT_EQ(slab.share, 1.0);
  EXPECT_FALSE(slab.warning());
}

// A bump that decays to the ambient density at all faces except those normal to one axis. If that axis is z, these are
// not side faces. If it is x, the rms of their profile sin^2 is 1/2: 50 % at the far face (1.2 of the range 1.2), and 8
// % at the near one (0.2).
TEST(SideFaces, ThatDifferFromTheAmbientAreReported) {
  auto const warning = [](char const* axes, double cell) {
    fs::path const folder = fs::path(testing::TempDir()) / "side_faces";
    fs::create_directories(folder);
    std::string const path = (folder / "layer.h5").string();
    std::vector<double> values;
    for (int z = 0; z < 9; ++z) {
      for (int y = 0; y < 9; ++y) {
        // a bump within the layer, with the ambient density at every face except those normal to the slowest axis
        for (int x = 0; x < 9; ++x) {
          double const fade = std::sin(M_PI * x / 8) * std::sin(M_PI * y / 8);
          values.push_back(1.225 + 0.5 * fade * (0.2 + z / 8.0));
        }
      }
    }
    Hdf5Writer writer(path, {"test", 1, "", 0, "cpu"});
    writer.write("rho", values, {9, 9, 9}, "1", "test", "z, y, x");
    writer.close();
    auto setup = table1_setup(512);
    setup.medium.field = {};
    setup.medium.field.kind = FieldKind::file;
    setup.medium.field.file = path;
    setup.medium.field.axes = axes;
    setup.medium.field.spacing = Vec3d{cell, cell, cell};
    auto const found = side_face_warning(build_medium(setup.medium), setup);
    fs::remove_all(folder);
    return found;
  };
  EXPECT_FALSE(warning("zyx", 1e-3));
  EXPECT_THAT(warning("xyz", 1e-3), Optional(Warns("implausible at medium.field",
                                                   AllOf(HasSubstr("x = 4 mm"), HasSubstr("medium.field.axes")))));
  EXPECT_FALSE(warning("xyz", 8e-3)) << "the faces are outside the view of 32.7 mm";
}

}  // namespace
}  // namespace gladstone
