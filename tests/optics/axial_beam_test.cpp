#include "render/optics/axial_beam.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/base/units.h"
#include "render/optics/lens_setup.h"
#include "tests/optics/prescription_texts.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Two lenses 2 mm through each other, whether a bare stop stands between them or not, and wherever it is told to stand.
TEST(AxialBeam, LensesThatOverlapAreRefusedAcrossAStop) {
  auto const pair = [](std::string const& between) {
    std::string const one =
        "[[surface]]\nradius_mm = 50\nthickness_mm = 8\nindex = 1.5\nsemi_diameter_mm = 15\n"
        "[[surface]]\nradius_mm = 30\nsemi_diameter_mm = 15\nthickness_mm = ";
    std::string const other =
        "[[surface]]\nradius_mm = 30\nthickness_mm = 8\nindex = 1.5\nsemi_diameter_mm = 15\n"
        "[[surface]]\nradius_mm = -50\nsemi_diameter_mm = 15\n";
    return "schema = 1\nentrance_pupil_mm = 10.0\n" + one + between + other;
  };
  std::string const stop = "[[surface]]\nstop = true\nthickness_mm = ";
  for (std::string const& between : {"-1\n" + stop + "-1\n", "1\n" + stop + "-3\n", "-3\n" + stop + "1\n"}) {
    EXPECT_THAT(refusal("ovstop.toml", pair(between)), AllOf(HasSubstr("overlap by 2 mm"), HasSubstr(".toml:")))
        << between;
  }
  EXPECT_EQ(refusal("apart.toml", pair("3\n" + stop + "-1\n")), "");
  std::string no_stop = pair("-2\n");
  no_stop.insert(no_stop.find("[[surface]]\n") + 12, "stop = true\n");
  EXPECT_THAT(refusal("ov.toml", no_stop), HasSubstr("overlap by 2 mm"));
}

// Faces of R = 60 mm, t = 0.2 mm apart, meet at r = sqrt(R^2 - (R - t/2)^2) = 3.46 mm.
TEST(AxialBeam, FacesThatCrossWithinItAreRefused) {
  double const meet = std::sqrt(60 * 60 - 59.9 * 59.9);
  auto const lens = [](double pupil) {
    return "schema = 1\nentrance_pupil_mm = " + std::to_string(pupil) +
           "\n[[surface]]\nradius_mm = 60\nthickness_mm = 0.2\nindex = 1.5\nstop = true\n[[surface]]\nradius_mm = "
           "-60\n";
  };
  EXPECT_EQ(refusal("thick.toml", lens(2 * meet - 0.02)), "");
  EXPECT_THAT(refusal("sharp.toml", lens(2 * meet + 0.4)), AllOf(HasSubstr("sharp.toml:8"), HasSubstr("faces cross")));
  EXPECT_THAT(refusal("sharp.toml", lens(30)), HasSubstr("faces cross"));
}

}  // namespace
}  // namespace gladstone
