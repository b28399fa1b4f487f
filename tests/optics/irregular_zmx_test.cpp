#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/base/units.h"
#include "render/optics/paraxial.h"
#include "tests/optics/lens_fixtures.h"
#include "tests/optics/prescription_texts.h"
#include "tests/support/expect_warning.h"

// Zemax files written or edited by hand or by other programs. One test for every row of the table of irregular files in
// docs/file-formats.md: each file is read with one warning that names its line.
namespace gladstone {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Lens read_lens(std::string const& name, std::string const& text, LensOptions const& options = {}) {
  return build_lens(read_prescription(file_of(name, text)), GlassCatalogue::shipped(), spectral_line::d, options);
}

double effective_length_mm(Lens const& lens) { return paraxial_lens(lens).effective_focal_length / unit::millimetre; }

/// Returns the focal length [mm] of a lens of radii +-50 mm by the lensmaker's equation, for the index relative to the
/// surroundings and the thickness [mm].
double biconvex_focal_length(double n, double thickness) {
  double const c = 0.02;
  return 1 / ((n - 1) * (2 * c - (n - 1) * thickness * c * c / n));
}

/// Returns the singlet with another line GLAS.
std::string with_glass(std::string const& words) {
  return changed(zmx, "GLAS N-BK7 0 0 1.5 40 0 0 0 0 0 0", "GLAS " + words);
}

/// Returns the singlet without its last three lines, followed by others.
std::string with_end(std::string const& end) { return changed(zmx, "SURF 3\n  TYPE STANDARD\n  DISZ 0\n", end); }

/// Rest of a block SURF: the image.
std::string const plane_block = "  TYPE STANDARD\n  DISZ 0\n";

// The numbers of the surfaces have gaps, fractions or suffixes, but increase: the order of the file is that of light.
TEST(IrregularZmx, SurfacesThatAreNotNumberedConsecutivelyAreInTheOrderOfTheFile) {
  double const f = effective_length_mm(read_lens("regular.zmx", zmx));
  Lens const gap = read_lens("gap.zmx", with_end("SURF 5\n" + plane_block));
  EXPECT_EQ(effective_length_mm(gap), f);
  EXPECT_THAT(gap.warnings, ElementsAre(Warns("assumed at gap.zmx:27")));
  // a plane in air between the lens and the image changes nothing
  for (std::string const number : {"2AS", "2.5"}) {
    Lens const lens = read_lens("part.zmx", with_end("SURF " + number + "\n  DISZ 0\nSURF 3\n" + plane_block));
    EXPECT_EQ(effective_length_mm(lens), f);
    EXPECT_EQ(lens.surfaces.size(), 3u);
    EXPECT_THAT(lens.warnings, ElementsAre(Warns("assumed at part.zmx:27")));
  }
}

// A meniscus that was turned round by hand, with its blocks in the order of light and numbers that decrease to 1. With
// n = 1.5, c1 = -0.02/mm, c2 = -0.04/mm and t = 5 mm, 1/f = 0.5 (c1 - c2 + t c1 c2 / 3).
TEST(IrregularZmx, SurfacesMayBeNumberedBackwards) {
  Lens const lens = read_lens("back.zmx",
                              "MODE SEQ\nUNIT MM\nENPD 5\nWAVM 1 0.5875618 1\nPWAV 1\nSURF 2.5\n  STOP\n  DISZ 20\n"
                              "SURF 2\n  CURV -0.02\n  DISZ 5\n  GLAS ___BLANK 1 0 1.5 0\nSURF 1\n  CURV -0.04\n"
                              "  DISZ 90\n");
  EXPECT_NEAR(effective_length_mm(lens), 1 / (0.5 * (0.02 + 5 * 0.0008 / 3)), 1e-10);
  EXPECT_EQ(lens.stop, 0);
  EXPECT_THAT(lens.warnings, ElementsAre(Warns("assumed at back.zmx:6"), Warns("assumed at back.zmx:6")));
}

// Numbers that repeat, or rise and fall, define no order; a first surface beyond 1 shows that the start is missing.
TEST(IrregularZmx, SurfacesWithoutAnOrderAreRefused) {
  EXPECT_EQ(refusal("twice.zmx", with_end("SURF 2\n" + plane_block)), "damaged at twice.zmx:27");
  EXPECT_EQ(refusal("falls.zmx", with_end("SURF 1\n" + plane_block)), "damaged at falls.zmx:27");
  EXPECT_EQ(refusal("headless.zmx", changed(changed(zmx, "SURF 0\n", ""), "SURF 1\n", "SURF 2\n")),
            "damaged at headless.zmx:21");
  EXPECT_EQ(refusal("late.zmx", "SURF 4\n" + plane_block + "SURF 5\n" + plane_block + "SURF 6\n" + plane_block),
            "damaged at late.zmx:1");
  EXPECT_EQ(refusal("word.zmx", with_end("SURF LAST\n" + plane_block)), "syntax at word.zmx:27");
  EXPECT_EQ(refusal("unnumbered.zmx", with_end("SURF\n" + plane_block)), "syntax at unnumbered.zmx:27");
}

// The aperture of the file opens a stop without DIAM: entrance pupil, f-number, numerical aperture of a point at 150
// mm. The stop is the first surface, so that it is as large as the entrance pupil, but for the sag of the surface.
TEST(IrregularZmx, AStopWithoutSemiDiameterIsOpenedByTheApertureOfTheFile) {
  std::string const bare = changed(zmx, "  DIAM 8.0 1 0 0 1 \"\"\n", "");
  double const f = effective_length_mm(read_lens("regular.zmx", zmx));
  auto const pupil_mm = [](Lens const& lens) { return paraxial_lens(lens).entrance.diameter / unit::millimetre; };
  EXPECT_NEAR(pupil_mm(read_lens("enpd.zmx", bare)), 6, 1e-12);
  EXPECT_NEAR(pupil_mm(read_lens("fnum.zmx", changed(bare, "ENPD 6.0", "FNUM 10"))), f / 10, 1e-12);
  std::string const cone = changed(changed(bare, "ENPD 6.0", "OBNA 0.02 0"), "DISZ INFINITY", "DISZ 150");
  EXPECT_NEAR(pupil_mm(read_lens("obna.zmx", cone)), 2 * 150 * std::tan(std::asin(0.02)), 1e-12);
  // or the f-number of a setup
  std::string const floating = changed(bare, "ENPD 6.0", "FLOA");
  LensOptions options;
  options.f_number = 10;
  EXPECT_NEAR(pupil_mm(read_lens("setup.zmx", floating, options)), f / 10, 1e-12);
  // nothing defines it; a numerical aperture does not for an object at infinity
  for (std::string const& text :
       {floating, changed(bare, "ENPD 6.0\n", ""), changed(bare, "ENPD 6.0", "OBNA 0.02 0")}) {
    EXPECT_THAT(refusal("open.zmx", text), testing::StartsWith("missing_content at open.zmx:"));
  }
}

// EVENASPH has terms up to r^16, ODDASPHE up to r^8 (OpticStudio's manual). 1e-22 r^18 mm is 1.8e-6 mm at 8 mm.
TEST(IrregularZmx, TermsBeyondTheEighthAreIgnored) {
  std::string const eight = changed(zmx, "  STOP\n  TYPE STANDARD\n", "  STOP\n  TYPE EVENASPH\n  PARM 2 1e-4\n");
  std::string const nine = changed(eight, "  PARM 2 1e-4\n", "  PARM 2 1e-4\n  PARM 9 1e-22\n  PARM 10 0\n");
  Lens const lens = read_lens("nine.zmx", nine);
  EXPECT_EQ(lens.prescription.surfaces[0].asphere, read_lens("eight.zmx", eight).prescription.surfaces[0].asphere);
  EXPECT_THAT(lens.warnings, ElementsAre(Warns("ignored at nine.zmx:19", HasSubstr("1.8e-06 mm"))));
  Lens const odd = read_lens("odd.zmx", changed(nine, "EVENASPH", "ODDASPHE"));
  EXPECT_EQ(odd.prescription.surfaces[0].radial.a.size(), 2u);
  EXPECT_THAT(odd.warnings, ElementsAre(Warns("ignored at odd.zmx:19")));
}

// Indices are relative to air: helium has 0.99976. The lens is in it, so that its focal length in air behind it follows
// from the powers of its faces, (1.5 - m) c and (1 - 1.5) (-c), with m ahead of it.
TEST(IrregularZmx, GasesHaveIndicesBelowThatOfAir) {
  double const m = 0.99976, n = 1.5, c = 0.02, t = 6;
  std::string const text =
      changed(with_glass("___BLANK 1 0 1.5 0"), "DISZ INFINITY", "DISZ INFINITY\n  GLAS ___BLANK 1 0 0.99976 50 0");
  Lens const lens = read_lens("helium.zmx", text);
  double const front = (n - m) * c, back = (n - 1) * c;
  EXPECT_NEAR(effective_length_mm(lens), 1 / (front + back - t / n * front * back), 1e-10);
  EXPECT_EQ(lens.object_index, m);
  EXPECT_THAT(lens.warnings, IsEmpty());
  EXPECT_EQ(refusal("thin.zmx", with_glass("___BLANK 1 0 0.999 0")), "out_of_range at thin.zmx:20");
}

// An optimiser may leave a glass at contact of its faces with a thickness of -25 nm, less than any tolerance.
TEST(IrregularZmx, AGlassThatEndsAtContactIsTraced) {
  std::string const concave = changed(changed(with_glass("___BLANK 1 0 1.5 0"), "CURV 0.02", "CURV -0.02"),
                                      "  CURV -0.02 0 0 0 0 \"\"\n  DISZ 47", "  CURV 0.02 0 0 0 0 \"\"\n  DISZ 47");
  Lens const lens = read_lens("contact.zmx", changed(concave, "DISZ 6.0", "DISZ -2.5e-5"));
  EXPECT_NEAR(effective_length_mm(lens), 1 / (-0.02 + 2.5e-5 / 1.5 * 1e-4), 1e-10);
  EXPECT_THAT(lens.warnings, ElementsAre(Warns("inconsistent at contact.zmx:22", HasSubstr("2.5e-05 mm"))));
  Ray<double> ray = parallel_ray(1);
  ASSERT_EQ(carry(lens, ray), RayStatus::alive);
  EXPECT_NEAR(ray.direction.y, 1.0 / 50, 2e-5);
  // without semi-diameters as edges
  std::string const drawn = changed(changed(concave, "DIAM 8.0 1", "DIAM 8.0 0"), "DIAM 8.0 1", "DIAM 8.0 0");
  EXPECT_THAT(read_lens("drawn.zmx", changed(drawn, "DISZ 6.0", "DISZ -2.5e-5")).warnings,
              ElementsAre(Warns("inconsistent at drawn.zmx:15", HasSubstr("2.5e-05 mm"))));
  EXPECT_EQ(refusal("crossed.zmx", changed(concave, "DISZ 6.0", "DISZ -2e-3")), "invalid_value at crossed.zmx:15");
}

// A Vd that is not a number leaves an index without dispersion; for a glass of a catalogue neither value is needed.
TEST(IrregularZmx, AnUnreadableAbbeNumberIsNoDispersion) {
  Lens const lens = read_lens("abbe.zmx", with_glass("___BLANK 1 0 1.5254 ? 0 0"));
  EXPECT_NEAR(effective_length_mm(lens), biconvex_focal_length(1.5254, 6), 1e-10);
  EXPECT_THAT(lens.warnings, ElementsAre(Warns("assumed at abbe.zmx:20", HasSubstr("1.5254"))));
  double const blue = 486.1e-9;
  EXPECT_EQ(effective_length_mm(build_lens(lens.prescription, GlassCatalogue::shipped(), blue)),
            effective_length_mm(lens));
  Lens const named = read_lens("named.zmx", with_glass("N-BK7 0 0 ? ?"));
  EXPECT_EQ(effective_length_mm(named), effective_length_mm(read_lens("regular.zmx", zmx)));
  EXPECT_THAT(named.warnings, ElementsAre(Warns("ignored at named.zmx:20")));
  EXPECT_EQ(refusal("index.zmx", with_glass("___BLANK 1 0 ? 60")), "syntax at index.zmx:20");
}

TEST(IrregularZmx, NumbersMayHaveADecimalComma) {
  std::string const text = changed(with_glass("___BLANK 1 0 1,5168 0"), "CURV -0.02", "CURV -2,0E-2");
  Lens const lens = read_lens("comma.zmx", text);
  EXPECT_NEAR(effective_length_mm(lens), biconvex_focal_length(1.5168, 6), 1e-10);
  EXPECT_THAT(lens.warnings, ElementsAre(Warns("assumed at comma.zmx:20", HasSubstr("1,5168"))));
  EXPECT_EQ(read_lens("title.zmx", changed(zmx, "NAME a singlet", "NAME 1,5")).prescription.title, "1,5");
  for (std::string const number : {"0,02,0", "1,000.0", "0,x", "0,"}) {
    EXPECT_EQ(refusal("list.zmx", changed(zmx, "CURV 0.02", "CURV " + number)), "syntax at list.zmx:18");
  }
}

// The maker's name selects the catalogue; a family or maker without a catalogue does not matter.
TEST(IrregularZmx, AGlassMayFollowMakerAndFamily) {
  double const f = effective_length_mm(read_lens("regular.zmx", zmx));
  Lens const lens = read_lens("family.zmx", with_glass("SCHOTT-BK|N-BK7"));
  EXPECT_EQ(effective_length_mm(lens), f);
  EXPECT_THAT(lens.warnings, ElementsAre(Warns("assumed at family.zmx:20", HasSubstr("N-BK7"))));
  EXPECT_EQ(effective_length_mm(read_lens("other.zmx", with_glass("CROWN|N-BK7"))), f);
  EXPECT_EQ(refusal("unknown.zmx", with_glass("SCHOTT-BK|N-BK999")), "unknown_choice at unknown.zmx:20");
}

}  // namespace
}  // namespace gladstone
