#include "render/optics/axial_beam.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/optics/paraxial.h"
#include "tests/optics/lens_fixtures.h"
#include "tests/optics/prescription_texts.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Two lenses that overlap by 2 mm, with or without a stop between them, and for any position of that stop.
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
    EXPECT_EQ(refusal("ovstop.toml", pair(between)), "invalid_value at ovstop.toml:15:1") << between;
  }
  EXPECT_EQ(refusal("apart.toml", pair("3\n" + stop + "-1\n")), "");
  std::string no_stop = pair("-2\n");
  no_stop.insert(no_stop.find("[[surface]]\n") + 12, "stop = true\n");
  EXPECT_EQ(refusal("ov.toml", no_stop), "invalid_value at ov.toml:13:1");
}

// Faces of R = 60 mm, t = 0.2 mm apart, meet at r = sqrt(R^2 - (R - t/2)^2) = 3.46 mm.
TEST(AxialBeam, WarnsOfSurfacesThatCrossWithinBeam) {
  double const meet = std::sqrt(60 * 60 - 59.9 * 59.9);
  auto const lens = [](double pupil) {
    return "schema = 1\nentrance_pupil_mm = " + std::to_string(pupil) +
           "\n[[surface]]\nradius_mm = 60\nthickness_mm = 0.2\nindex = 1.5\nstop = true\n[[surface]]\nradius_mm = "
           "-60\n";
  };
  auto const warnings = [&](double pupil) {
    return build_lens(read_prescription(file_of("sharp.toml", lens(pupil))), GlassCatalogue::shipped(),
                      spectral_line::d)
        .warnings;
  };
  EXPECT_THAT(warnings(2 * meet - 0.02), IsEmpty());
  EXPECT_THAT(warnings(2 * meet + 0.4), ElementsAre(Warns("inconsistent at sharp.toml:8:1")));
  EXPECT_THAT(warnings(30), ElementsAre(Warns("inconsistent at sharp.toml:8:1")));
}

// A singlet of f/8 with a requested f-number of 2 opens as far as its edges permit, and a warning reports this. A plane
// of semi-diameter 8 mm in front of the lens limits rays parallel to the axis, so that the lens passes f / 16 mm.
TEST(AxialBeam, WarnsOfFNumberBelowLensLimit) {
  auto const at = [](double f_number, std::string const& text) {
    LensOptions options;
    options.f_number = f_number;
    return build_lens(read_prescription(file_of("wide.toml", text)), GlassCatalogue::shipped(), spectral_line::d,
                      options);
  };
  std::string const edged =
      changed(toml, "[[surface]]\n", "[[surface]]\nradius_mm = inf\nsemi_diameter_mm = 8.0\n[[surface]]\n");
  double const n = GlassCatalogue::shipped().match("N-BK7", spectral_line::d, "").glass->nd();
  double const f = 50 / (2 * (n - 1) - (n - 1) * (n - 1) * 6 / (n * 50));
  EXPECT_THAT(at(8, edged).warnings, IsEmpty());
  EXPECT_THAT(at(11, edged).warnings, IsEmpty());
  EXPECT_THAT(at(4, edged).warnings, ElementsAre(Warns("unsuitable at wide.toml", HasSubstr("f/8"))));
  EXPECT_THAT(at(2, edged).warnings,
              ElementsAre(Warns("unsuitable at wide.toml",
                                AllOf(HasSubstr("f/2"), HasSubstr(fmt::format("f/{:.4g}", f / 16))))));
  // An aperture of 2 mm on the stop limits it, which is also reported.
  LensOptions options;
  options.f_number = 4;
  Lens const closed =
      build_lens(read_prescription(file_of("closed.zmx", changed(zmx, "  STOP\n", "  STOP\n  CLAP 0 2.0 0\n"))),
                 GlassCatalogue::shipped(), spectral_line::d, options);
  EXPECT_THAT(closed.warnings, ElementsAre(testing::Field(&Warning::text, HasSubstr(fmt::format("f/{:.4g}", f / 4)))));
}

// The f/2 double Gauss transmits its axial beam completely, but little more: at f/1.2, light is lost at its edges.
TEST(AxialBeam, TheDoubleGaussDoesNotPassF1Point2) {
  LensOptions options;
  options.f_number = 1.2;
  Lens const lens = build_lens(read_prescription(GLADSTONE_DATA_DIR "/lenses/double_gauss.toml"),
                               GlassCatalogue::shipped(), spectral_line::d, options);
  ASSERT_EQ(lens.warnings.size(), 1u);
  std::string const& text = lens.warnings[0].text;  // the last f-number is that of the widest beam
  double const widest = std::stod(text.substr(text.rfind("f/") + 2));
  EXPECT_GT(widest, 1.2);
  EXPECT_LE(widest, 2);
  for (double const inside : {0.99, 1.01}) {  // a ray inside the reported beam passes, one outside is vignetted
    Ray<double> ray = parallel_ray(inside * 0.5e3 * paraxial_lens(lens).effective_focal_length / widest);
    EXPECT_EQ(carry(lens, ray) == RayStatus::alive, inside < 1) << widest;
  }
}

}  // namespace
}  // namespace gladstone
