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

/// A .zmx file of these blocks SURF, numbered in their order; the object, at a distance, comes ahead of them.
std::string zmx_of(std::initializer_list<std::string> blocks, std::string const& object = "INFINITY") {
  std::string text =
      "MODE SEQ\nUNIT MM\nENPD 10\nFTYP 0 0 1 1\nYFLN 0\nWAVM 1 0.5876 1\nPWAV 1\nSURF 0\n  DISZ " + object;
  int number = 0;
  for (std::string const& block : blocks) text += "\nSURF " + std::to_string(++number) + "\n  " + block;
  return text + '\n';
}

Lens broken_lens(std::string const& name, std::string const& text) {
  return build_lens(read_prescription(file_of(name, text)), GlassCatalogue::shipped(), spectral_line::d);
}

// An equiconvex lens of N = 1.5, R = 60 mm, 4 mm thick, then one of R = 80 mm; model glass without dispersion.
std::string const front = "STOP\n  CURV 0.016666666666666667\n  DISZ 4\n  GLAS ___BLANK 1 0 1.5 0";
std::string const third = "CURV 0.0125\n  DISZ 4\n  GLAS ___BLANK 1 0 1.5 0";
std::string const fourth = "CURV -0.0125\n  DISZ 30";
std::string const image = "CURV 0\n  DISZ 0";

double thick_focal_length(double n, double radius, double thickness) {
  return 1 / ((n - 1) * (2 / radius - (n - 1) * thickness / (n * radius * radius)));
}

// The airspace between two lenses may stand in a break. f = f1 f2 / (f1 + f2 - d), d from principal plane to principal
// plane, each (n - 1) f t / (n R) inside its lens.
TEST(CoordinateBreak, ItsThicknessIsAnAirspace) {
  std::string const by_break =
      zmx_of({front, "CURV -0.016666666666666667\n  DISZ 0", "TYPE COORDBRK\n  DISZ 20", third, fourth, image});
  std::string const by_surface = zmx_of({front, "CURV -0.016666666666666667\n  DISZ 20", third, fourth, image});
  double const f1 = thick_focal_length(1.5, 60, 4), f2 = thick_focal_length(1.5, 80, 4);
  double const d = 20 + 0.5 * f1 * 4 / (1.5 * 60) + 0.5 * f2 * 4 / (1.5 * 80);
  for (std::string const& text : {by_break, by_surface}) {
    ParaxialLens const paraxial = paraxial_lens(broken_lens("air.zmx", text));
    EXPECT_NEAR(paraxial.effective_focal_length * 1e3, f1 * f2 / (f1 + f2 - d), 1e-11);
  }
}

// Ahead of the first surface it adds to the object's distance: 100 + 20 mm, wherever the break puts them.
TEST(CoordinateBreak, ItsThicknessAddsToTheObjectsDistance) {
  std::string const last = "CURV -0.016666666666666667\n  DISZ 0";
  Lens const lens = broken_lens("object.zmx", zmx_of({"TYPE COORDBRK\n  DISZ 20", front, last, image}, "100"));
  EXPECT_NEAR(lens.prescription.object_distance, 0.12, 1e-16);
  EXPECT_EQ(lens.poses[0].origin.z, 0);
  ParaxialLens const paraxial = paraxial_lens(lens);
  double const object = 0.12 + paraxial.front_principal_plane, f = paraxial.effective_focal_length;
  EXPECT_NEAR(analyse_field(lens, paraxial, 100).image_plane, 1 / (1 / f - 1 / object) + paraxial.rear_principal_plane,
              1e-14);
  EXPECT_THAT(refusal("endless.zmx", zmx_of({front, last, "TYPE COORDBRK\n  DISZ INFINITY", third, fourth, image})),
              HasSubstr("coordinate break"));
}

}  // namespace
}  // namespace gladstone
