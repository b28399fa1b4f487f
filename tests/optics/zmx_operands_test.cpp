#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/base/units.h"
#include "render/optics/paraxial.h"
#include "tests/optics/lens_fixtures.h"
#include "tests/optics/prescription_texts.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Returns the singlet with an additional line in its second surface.
std::string with_operand(std::string const& line) {
  return changed(zmx, "  CURV -0.02", "  " + line + "\n  CURV -0.02");
}

Warnings notes_of(std::string const& name, std::string const& text) {
  return read_prescription(file_of(name, text)).warnings;
}

/// Traces a ray parallel to the axis at a height through a lens whose stop is wide open.
RayStatus fate(Lens lens, double height_mm) {
  lens.surfaces[0] = lens.surfaces[0].visit([](auto opened) -> LensSurface<double> {
    opened.semi_diameter = 8 * unit::millimetre;
    return opened;
  });
  Ray<double> ray = parallel_ray(height_mm);
  return carry(lens, ray);
}

// A circular aperture is an edge, whatever the semi-diameter of the surface; an obscuring disc in the middle blocks the
// rays that meet it. Rays of the singlet at 2, 4 and 6 mm meet its second face a tenth lower.
TEST(ZmxOperands, CircularAperturesAndObscurationsAreTraced) {
  Lens const bare = read_lens("bare.zmx", zmx);
  for (double const height : {1.0, 4.0, 6.0}) EXPECT_EQ(fate(bare, height), RayStatus::alive);
  Lens const closed = read_lens("clap.zmx", with_operand("CLAP 0 5.0 0"));
  EXPECT_EQ(fate(closed, 4), RayStatus::alive);
  EXPECT_EQ(fate(closed, 6), RayStatus::vignetted);
  Lens const ring = read_lens("ring.zmx", with_operand("CLAP 2.0 5.0 0"));
  EXPECT_EQ(fate(ring, 1), RayStatus::vignetted);
  EXPECT_EQ(fate(ring, 4), RayStatus::alive);
  Lens const obscured = read_lens("obsc.zmx", with_operand("OBSC 0 2.0 0"));
  EXPECT_EQ(fate(obscured, 1), RayStatus::vignetted);
  EXPECT_EQ(fate(obscured, 4), RayStatus::alive);
  EXPECT_EQ(fate(read_lens("flap.zmx", with_operand("FLAP 0 5.0 0")), 6), RayStatus::vignetted);
}

// Like above, in CODE V and in TOML.
TEST(ZmxOperands, OtherFormatsHaveTheSameObscuration) {
  auto const of = [](char const* name, std::string const& text) { return read_lens(name, text); };
  EXPECT_EQ(fate(of("obs.seq", changed(seq, "CIR 8.0", "CIR 8.0; CIR OBS 2.0")), 1), RayStatus::vignetted);
  EXPECT_EQ(fate(of("obs.toml", changed(toml, "stop = true", "stop = true\nobscured_mm = 2.0")), 1),
            RayStatus::vignetted);
}

// An aperture on the stop limits the system aperture: the radius is 2 mm, not 3 mm.
TEST(ZmxOperands, AnApertureOnTheStopBoundsIt) {
  Lens const lens = read_lens("stopped.zmx", changed(zmx, "  STOP\n", "  STOP\n  CLAP 0 2.0 0\n"));
  EXPECT_NEAR(lens.stop_radius, 2e-3, 1e-15);
  EXPECT_NEAR(paraxial_lens(lens).entrance.diameter, 4e-3, 1e-15);
}

// A semi-diameter computed by the design program (flag 0) is for drawings and does not vignette; a given one (flag 1)
// is an edge, and so is an aperture.
TEST(ZmxOperands, AnAutomaticSemiDiameterIsNoEdge) {
  std::string const given = changed(zmx, "DISZ 47.0\n  DIAM 8.0 1", "DISZ 47.0\n  DIAM 3.0 1");
  std::string const automatic = changed(zmx, "DISZ 47.0\n  DIAM 8.0 1", "DISZ 47.0\n  DIAM 3.0 0");
  EXPECT_EQ(fate(read_lens("given.zmx", given), 4), RayStatus::vignetted);
  Lens const lens = read_lens("automatic.zmx", automatic);
  EXPECT_EQ(fate(lens, 4), RayStatus::alive);
  EXPECT_EQ(lens.prescription.surfaces[1].semi_diameter, 3e-3);  // as in the drawing
  EXPECT_EQ(fate(read_lens("clap.zmx", changed(automatic, "  DIAM 3.0", "  CLAP 0 3.0 0\n  DIAM 3.0")), 4),
            RayStatus::vignetted);
}

// Shapes that are not traced are ignored with a warning that contains line and operand; impossible shapes are refused.
TEST(ZmxOperands, UnsupportedAperturesCauseWarningsWithTheirName) {
  for (char const* const line : {"SPID 0.5 3 0", "UDAP 0 0", "UDOB 0 0", "OBSC 1 2 0"}) {
    std::string const key = std::string(line).substr(0, 4);
    EXPECT_THAT(notes_of("block.zmx", with_operand(line)),
                ElementsAre(Warns("ignored at block.zmx:24", HasSubstr(key))));
  }
  EXPECT_THAT(notes_of("on.zmx", with_operand("OBDC 0 0")), IsEmpty());
  EXPECT_EQ(refusal("turned.zmx", with_operand("CLAP 5 2 0")), "invalid_value at turned.zmx:24");
  EXPECT_EQ(refusal("flat.zmx", with_operand("SQAP 3 0 0")), "out_of_range at flat.zmx:24");
}

// A ring-shaped obscuration that extends to the edge of the surface leaves a circular aperture; if a disc is as large
// as the surface, light passes outside.
TEST(ZmxOperands, ObscurationsThatReachTheEdgeAreTraced) {
  Lens const circle = read_lens("circle.zmx", with_operand("OBSC 3 9 0"));
  EXPECT_EQ(fate(circle, 2), RayStatus::alive);
  EXPECT_EQ(fate(circle, 4), RayStatus::vignetted);
  EXPECT_THAT(notes_of("large.zmx", with_operand("OBSC 0 9 0")), ElementsAre(Warns("assumed at large.zmx:24")));
}

// Operands that only change the amount of light cause a warning, and so do unknown ones.
TEST(ZmxOperands, IgnoredOperandsCauseWarnings) {
  EXPECT_THAT(notes_of("quiet.zmx", zmx), IsEmpty());
  EXPECT_THAT(notes_of("quiet.zmx", changed(zmx, "PWAV 2", "PWAV 2\nVCYN 0 0 0")), IsEmpty());
  EXPECT_THAT(notes_of("vignetting.zmx", changed(zmx, "PWAV 2", "PWAV 2\nVCYN 0 0.2 0")),
              ElementsAre(Warns("ignored at vignetting.zmx:11")));
  EXPECT_THAT(notes_of("coat.zmx", with_operand("COAT AR")), ElementsAre(Warns("ignored at coat.zmx:24")));
  EXPECT_THAT(notes_of("new.zmx", with_operand("QQQQ 1 2")), ElementsAre(Warns("ignored at new.zmx:24")));
  EXPECT_THAT(read_lens("kept.zmx", with_operand("QQQQ 1 2")).warnings, Contains(Warns("ignored at kept.zmx:24")));
  EXPECT_THAT(notes_of("hot.zmx", changed(zmx, "PWAV 2", "PWAV 2\nENVD 40 1 1")),
              ElementsAre(Warns("ignored at hot.zmx:11")));
  EXPECT_THAT(notes_of("cold.zmx", changed(zmx, "PWAV 2", "PWAV 2\nENVD 20 1 1")), IsEmpty());
  EXPECT_THAT(notes_of("twice.zmx", changed(with_operand("COAT AR"), "  STOP\n", "  STOP\n  COAT AR\n")),
              ElementsAre(Warns("ignored at twice.zmx:17")));
}

// FNUM and OBNA have two meanings each. The working f-number of a lens with an object at the distance s is v / D for an
// image at v: 1/(2 u') of the marginal ray; the half angle of a cone is the arcsine of the numerical aperture.
TEST(ZmxOperands, AperturesMeanWhatTheirSecondValueSays) {
  std::string const near = changed(zmx, "DISZ INFINITY", "DISZ 150.0");
  Lens const lens = read_lens("working.zmx", changed(near, "ENPD 6.0", "FNUM 20 1"));
  RayTransfer const m = ray_transfer(lens, 0, 2);
  double const u = lens.paraxial_stop_radius / 0.15;  // the stop is the first surface
  EXPECT_NEAR(std::abs(m.c * 0.15 * u + m.d * u), 1 / (2 * 20.0), 1e-15);
  Lens const infinite = read_lens("infinite.zmx", changed(near, "ENPD 6.0", "FNUM 20 0"));
  EXPECT_NEAR(paraxial_lens(infinite).f_number, 20, 1e-12);
  Lens const cone = read_lens("cone.zmx", changed(near, "ENPD 6.0", "OBNA 1.5 1")),
             na = read_lens("na.zmx", changed(near, "ENPD 6.0", "OBNA 0.0261769483078732 0"));  // sin 1.5 degrees
  EXPECT_NEAR(cone.stop_radius / na.stop_radius, 1, 1e-13);
}

// Model glasses have no dispersion if Vd is 0; otherwise, only plausible values are accepted. A glass thickness against
// the direction of light is refused, except behind a mirror.
TEST(ZmxOperands, ModelGlassesAndNegativeThicknessesAreChecked) {
  auto const model = [](char const* text) {
    return changed(zmx, "GLAS N-BK7 0 0 1.5 40", std::string("GLAS ") + text);
  };
  Lens const plain = read_lens("plain.zmx", model("___BLANK 1 0 1.6 0"));
  double const f = 50 / (2 * 0.6 - 0.36 * 6 / (1.6 * 50));
  EXPECT_NEAR(paraxial_lens(plain).effective_focal_length * 1e3, f, 1e-11);
  EXPECT_EQ(refusal("thin.zmx", model("___BLANK 1 0 0.9 40")), "out_of_range at thin.zmx:20");
  EXPECT_EQ(refusal("minus.zmx", model("___BLANK 1 0 -1.5 40")), "out_of_range at minus.zmx:20");
  EXPECT_EQ(refusal("abbe.zmx", model("___BLANK 1 0 1.5 -40")), "out_of_range at abbe.zmx:20");
  EXPECT_THAT(notes_of("deviation.zmx", model("___BLANK 1 0 1.5 40 0.01")),
              Contains(Warns("ignored at deviation.zmx:20")));
  EXPECT_EQ(refusal("back.zmx", changed(zmx, "DISZ 6.0", "DISZ -6.0")), "invalid_value at back.zmx:15");
}

// The ray along the axis must pass the lens; otherwise, the surface and the cause are reported.
TEST(ZmxOperands, AnAxialRayThatIsLostNamesItsSurface) {
  std::string const turned = changed(toml, "thickness_mm = 0.0", "thickness_mm = 0.0\ntilt_deg = [89, 0, 0]");
  EXPECT_EQ(refusal("tilted.toml", turned), "invalid_value at tilted.toml:9:1");
  std::string const steep = changed(toml, "thickness_mm = 0.0", "thickness_mm = 0.0\ntilt_deg = [50, 0, 0]");
  EXPECT_EQ(refusal("steep.toml", steep), "invalid_value at steep.toml:9:1");
}

}  // namespace
}  // namespace gladstone
