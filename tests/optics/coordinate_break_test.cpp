#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/base/units.h"
#include "render/optics/field_analysis.h"
#include "render/optics/paraxial.h"
#include "tests/optics/prescription_texts.h"

namespace gladstone {
namespace {

using testing::HasSubstr;

/// Returns a .zmx file with these blocks SURF, numbered in their order, after the object at a given distance.
std::string zmx_of(std::initializer_list<std::string> blocks, std::string const& object = "INFINITY") {
  std::string text =
      "MODE SEQ\nUNIT MM\nENPD 10\nFTYP 0 0 1 1\nYFLN 0\nWAVM 1 0.5876 1\nPWAV 1\nSURF 0\n  DISZ " + object;
  int number = 0;
  for (std::string const& block : blocks) text += "\nSURF " + std::to_string(++number) + "\n  " + block;
  return text + '\n';
}

// An equiconvex lens of N = 1.5, R = 60 mm, 4 mm thick, then one of R = 80 mm; model glass without dispersion.
constexpr char const* front_face = "STOP\n  CURV 0.016666666666666667\n  DISZ 4\n  GLAS ___BLANK 1 0 1.5 0";
constexpr char const* third_face = "CURV 0.0125\n  DISZ 4\n  GLAS ___BLANK 1 0 1.5 0";
constexpr char const* fourth_face = "CURV -0.0125\n  DISZ 30";
constexpr char const* image_block = "CURV 0\n  DISZ 0";

double thick_focal_length(double n, double radius, double thickness) {
  return 1 / ((n - 1) * (2 / radius - (n - 1) * thickness / (n * radius * radius)));
}

// The airspace between two lenses may be contained in a coordinate break. f = f1 f2 / (f1 + f2 - d), with d between the
// principal planes, each of which is (n - 1) f t / (n R) inside its lens.
TEST(CoordinateBreak, ItsThicknessIsAnAirspace) {
  std::string const by_break = zmx_of({front_face, "CURV -0.016666666666666667\n  DISZ 0", "TYPE COORDBRK\n  DISZ 20",
                                       third_face, fourth_face, image_block});
  std::string const by_surface =
      zmx_of({front_face, "CURV -0.016666666666666667\n  DISZ 20", third_face, fourth_face, image_block});
  double const f1 = thick_focal_length(1.5, 60, 4), f2 = thick_focal_length(1.5, 80, 4);
  double const d = 20 + 0.5 * f1 * 4 / (1.5 * 60) + 0.5 * f2 * 4 / (1.5 * 80);
  for (std::string const& text : {by_break, by_surface}) {
    ParaxialLens const paraxial = paraxial_lens(read_lens("air.zmx", text));
    EXPECT_NEAR(paraxial.effective_focal_length * 1e3, f1 * f2 / (f1 + f2 - d), 1e-11);
  }
}

// Ahead of the first surface, a break adds to the object distance: 100 + 20 mm, at any position of the break.
TEST(CoordinateBreak, ItsThicknessAddsToTheObjectsDistance) {
  std::string const last = "CURV -0.016666666666666667\n  DISZ 0";
  Lens const lens = read_lens("object.zmx", zmx_of({"TYPE COORDBRK\n  DISZ 20", front_face, last, image_block}, "100"));
  EXPECT_NEAR(lens.prescription.object_distance, 0.12, 1e-16);
  EXPECT_EQ(lens.poses[0].origin.z, 0);
  ParaxialLens const paraxial = paraxial_lens(lens);
  double const object = 0.12 + paraxial.front_principal_plane, f = paraxial.effective_focal_length;
  EXPECT_NEAR(analyse_field(lens, paraxial, 100).image_plane, 1 / (1 / f - 1 / object) + paraxial.rear_principal_plane,
              1e-14);
  EXPECT_EQ(refusal("endless.zmx",
                    zmx_of({front_face, last, "TYPE COORDBRK\n  DISZ INFINITY", third_face, fourth_face, image_block})),
            "out_of_range at endless.zmx:18");
  EXPECT_EQ(refusal("far.zmx",
                    zmx_of({front_face, last, "TYPE COORDBRK\n  DISZ 1e300", third_face, fourth_face, image_block})),
            "out_of_range at far.zmx:21");
}

// Newtonian telescope: a paraboloid of f = 200 mm, a flat mirror at 45 degrees 150 mm in front of it, and the image 50
// mm from the axis. The second break is followed by the image, or by a reference plane and then the image. In both
// cases, parallel light is focused on the axis, and light of a field angle u at f tan u.
TEST(CoordinateBreak, AheadOfTheImageItTurnsTheImage) {
  std::string const paraboloid = "STOP\n  CURV -0.0025\n  CONI -1\n  DISZ -150\n  GLAS MIRROR 0 0";
  std::string const flat = "CURV 0\n  DISZ 0\n  GLAS MIRROR 0 0", turn = "TYPE COORDBRK\n  PARM 3 45\n  DISZ ";
  std::string const by_break = zmx_of({"DISZ 170", paraboloid, turn + "0", flat, turn + "50", image_block});
  std::string const by_plane = zmx_of({"DISZ 170", paraboloid, turn + "0", flat, turn + "0", "DISZ 50", image_block});
  for (std::string const& text : {by_break, by_plane}) {
    Lens lens = read_lens("newton.zmx", text);
    lens.prescription.field_angles = {0, 0.1 * unit::degree};
    ParaxialLens const paraxial = paraxial_lens(lens);
    EXPECT_NEAR(paraxial.effective_focal_length, 0.2, 1e-15);
    FieldAnalysis const field = analyse_field(lens, paraxial, 200);
    EXPECT_NEAR(field.image_plane, 0.05, 1e-16);
    EXPECT_LT(field.points[0].spot_rms, 1e-14);
    EXPECT_LT(length(field.points[0].chief), 1e-14);
    // the chief ray meets the vertex of the paraboloid and is deflected by 2 u: exactly f tan u on a plane 200 mm away
    EXPECT_NEAR(length(field.points[1].chief), 0.2 * std::tan(0.1 * unit::degree), 1e-14);
    Vec3d const centre = lens.poses.back().moved({0, 0, field.image_plane}).origin;
    EXPECT_LT(length(centre - Vec3d{0, centre.y, 0.17 - 0.15}), 1e-16);
    EXPECT_NEAR(std::abs(centre.y), 0.05, 1e-16);
  }
}

// A break that only tilts the image: the plane remains at the position given by the preceding thickness, at a distance
// of 0 behind the break.
TEST(CoordinateBreak, ATiltedImageStaysInItsPlace) {
  std::string const last = "CURV -0.016666666666666667\n  DISZ 50";
  Lens const lens =
      read_lens("tilt.zmx", zmx_of({front_face, last, "TYPE COORDBRK\n  PARM 3 10\n  DISZ 0", image_block}));
  std::string const tilted =
      changed(changed(changed(seq, "SI 0.0 0.0", "SI 0.0 0.0; ADE -10"), "50.0 6.0", "60.0 4.0"), "47.0", "50.0");
  for (Lens const& held : {lens, read_lens("tilt.seq", tilted)}) {
    EXPECT_EQ(analyse_field(held, paraxial_lens(held), 100).image_plane, 0);
    EXPECT_LT(length(held.poses.back().origin - Vec3d{0, 0, 0.054}), 1e-16);
    EXPECT_NEAR(std::abs(held.poses.back().z.y), std::sin(10 * unit::degree), 1e-15);
  }
}

}  // namespace
}  // namespace gladstone
