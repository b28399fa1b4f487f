#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/optics/field_analysis.h"
#include "render/optics/paraxial.h"
#include "tests/optics/lens_fixtures.h"
#include "tests/optics/prescription_texts.h"
#include "tests/support/expect_warning.h"

// One test for every row of the first table of .zmx, .seq and .agf files in docs/file-formats.md. The files in
// tests/cases/lenses each have one property of files written by other programs.
namespace gladstone {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;

std::string case_path(std::string const& name) {
  return std::string(GLADSTONE_DATA_DIR) + "/../tests/cases/lenses/" + name;
}

Lens lens_at(std::string const& path, GlassCatalogue const& glasses = GlassCatalogue::shipped()) {
  Prescription prescription = read_prescription(path);
  double const given = prescription.primary_wavelength;
  return build_lens(std::move(prescription), glasses, given > 0 ? given : spectral_line::d);
}
Lens lens_of_case(std::string const& name, GlassCatalogue const& glasses = GlassCatalogue::shipped()) {
  return lens_at(case_path(name), glasses);
}
Lens lens_of_text(std::string const& name, std::string const& text) { return lens_at(file_of(name, text)); }

double focal_length_mm(Lens const& lens) { return paraxial_lens(lens).effective_focal_length / unit::millimetre; }

/// Returns the focal length by the y-nu trace of Welford (1986), chapter 3: curvatures [1/mm], indices ahead of,
/// between and behind the surfaces, thicknesses [mm].
double traced_focal_length(std::vector<double> const& curvatures, std::vector<double> const& indices,
                           std::vector<double> const& thicknesses) {
  double y = 1, nu = 0;
  for (std::size_t i = 0; i < curvatures.size(); ++i) {
    nu -= y * curvatures[i] * (indices[i + 1] - indices[i]);
    if (i < thicknesses.size()) y += thicknesses[i] * nu / indices[i + 1];
  }
  return -1 / nu;
}

/// Index of N-BK7 at the d line.
double bk7() { return GlassCatalogue::shipped().match("N-BK7", spectral_line::d, "").glass->nd(); }

/// Focal length of the doublet in most of the files, 75.945005 mm.
double doublet_focal_length(double crown = 1.62041, double flint = 1.71736) {
  return traced_focal_length({1 / 62.5, -1 / 44.0, -1 / 128.0}, {1, crown, flint, 1}, {5, 2.2});
}

/// Returns the sag of the first surface at a height [mm].
double sag_of_first_surface(Lens const& lens, double height_mm) {
  return lens.surfaces[0].visit([&](auto const& s) { return s.shape.sag(0.0, height_mm * unit::millimetre); }) /
         unit::millimetre;
}

double sphere_sag(double curvature, double r) {
  return curvature * r * r / (1 + std::sqrt(1 - curvature * curvature * r * r));
}

/// Traces a ray parallel to the axis at a position [mm] through a lens whose stop is wide open.
RayStatus fate(Lens lens, Vec2d place_mm) {
  auto& stop = lens.surfaces[static_cast<std::size_t>(lens.stop)];
  stop = stop.visit([](auto opened) -> LensSurface<double> {
    opened.semi_diameter = HUGE_VAL;
    return opened;
  });
  Ray<double> ray{{place_mm.x * unit::millimetre, place_mm.y * unit::millimetre, -0.1}, {0, 0, 1}};
  return carry(lens, ray);
}

TEST(LensFiles, TheDoubletIsThatOfThePublishedFocalLength) { EXPECT_NEAR(doublet_focal_length(), 75.945005, 5e-7); }

TEST(LensFiles, TheLastLineNeedsNoEnd) {
  Lens const lens = lens_of_case("no_final_newline.zmx");
  EXPECT_NEAR(focal_length_mm(lens), doublet_focal_length(), 1e-10);
  EXPECT_THAT(lens.warnings, Contains(Warns("incomplete at no_final_newline.zmx:33")));
}

// An aperture from 7.5 mm to infinity around a pupil of 6 mm would block all light and is ignored; one from 2 mm on
// blocks a disc.
TEST(LensFiles, AnApertureMayHaveNoUpperLimit) {
  Lens const lens = lens_of_case("clap_inf.zmx");
  EXPECT_NEAR(focal_length_mm(lens), doublet_focal_length(), 1e-10);
  EXPECT_THAT(lens.warnings, Contains(Warns("ignored at clap_inf.zmx:12")));
  EXPECT_EQ(fate(lens, {0, 3}), RayStatus::alive);
  Lens const ring = lens_of_text("ring.zmx", changed(zmx, "  STOP\n", "  STOP\n  CLAP 2 INF 0\n"));
  EXPECT_EQ(fate(ring, {0, 1}), RayStatus::vignetted);
  EXPECT_EQ(fate(ring, {0, 2.5}), RayStatus::alive);
}

TEST(LensFiles, AnUnknownGlassHasNdAndVdInItsLine) {
  Lens const lens = lens_of_case("glass_by_nd_vd.zmx");
  EXPECT_NEAR(focal_length_mm(lens), doublet_focal_length(), 1e-10);
  EXPECT_THAT(lens.warnings,
              ElementsAre(testing::Field(&Warning::text, AllOf(HasSubstr("MYCROWN"), HasSubstr("1.62041"))),
                          testing::Field(&Warning::text, AllOf(HasSubstr("MYFLINT"), HasSubstr("29.5")))));
}

// The warning lists every glass specified by nd and Vd with its line: GLAS, S, SO or GLA.
TEST(LensFiles, WarningsOfGlassesNameTheLineOfEachGlass) {
  EXPECT_THAT(lens_of_case("object_in_water.zmx").warnings,
              Contains(Warns("approximated at object_in_water.zmx:16", HasSubstr("nd 1.33300, Vd 55.80"))));
  std::string const water = changed(changed(seq, "SO 0.0 1e13", "SO 0.0 1e13 1.333:55.8"), "NBK7_SCHOTT", "517642");
  EXPECT_THAT(lens_of_text("water.seq", changed(water, "STO;", "STO;\n GLA 1.62:60.3;")).warnings,
              Contains(Warns("approximated at water.seq:7", AllOf(HasSubstr("nd 1.33300, Vd 55.80 (line 7)"),
                                                                  HasSubstr("nd 1.62000, Vd 60.30 (line 10)")))));
}

// 1.5 and 40 are Zemax's default values for unknown nd and Vd; they do not describe a glass.
TEST(LensFiles, FilledInIndicesDescribeNoGlass) {
  EXPECT_EQ(refusal("filled.zmx", changed(zmx, "N-BK7 0 0 1.5 40", "NOGLASS 0 0 1.5 40")),
            "unknown_choice at filled.zmx:20");
}

// A six-digit code: nd - 1 in thousandths, ten times Vd.
TEST(LensFiles, MilCodesAreGlasses) {
  double const f = traced_focal_length({0.02, -0.02}, {1, 1.517, 1}, {5});
  EXPECT_NEAR(focal_length_mm(lens_of_case("mil_glass.zmx")), f, 1e-10);
  EXPECT_NEAR(focal_length_mm(lens_of_text("mil.seq", changed(seq, "NBK7_SCHOTT", "517642"))),
              traced_focal_length({0.02, -0.02}, {1, 1.517, 1}, {6}), 1e-10);
}

// GLAS of surface 0 is the medium of the object: power -c2 (1 - n) - ..., focal length 72.011 mm in air behind the
// lens. The front focal length is measured in water and n times as long.
TEST(LensFiles, TheObjectMayLieInWater) {
  double const glass = bk7(), water = 1.333;
  Lens const lens = lens_of_case("object_in_water.zmx");
  EXPECT_NEAR(lens.object_index, water, 1e-12);
  double const f = traced_focal_length({0.02, -0.02}, {water, glass, 1}, {5});
  EXPECT_NEAR(f, 72.0111, 5e-5);
  EXPECT_NEAR(focal_length_mm(lens), f, 1e-7);
  // backwards, from air into water: the other focus is at n f from its principal plane
  double const back = traced_focal_length({0.02, -0.02}, {1, glass, water}, {5});
  EXPECT_NEAR(back, f, 1e-7);
  ParaxialLens const paraxial = paraxial_lens(lens);
  EXPECT_NEAR((paraxial.front_principal_plane - paraxial.front_focal_length) / unit::millimetre, water * f, 1e-7);
  EXPECT_NEAR((paraxial.back_focal_length - paraxial.rear_principal_plane) / unit::millimetre, f, 1e-7);
  // a real ray close to the axis meets the paraxial focus: spherical aberration is proportional to the square of the
  // height
  Ray<double> ray{{0, 1e-5, -0.01}, {0, 0, 1}};
  ASSERT_EQ(carry(lens, ray), RayStatus::alive);
  double const meets = ray.position.z - ray.position.y * ray.direction.z / ray.direction.y;
  EXPECT_NEAR(meets - lens.poses.back().origin.z, paraxial.back_focal_length, 1e-8);
}

// The image of a point in water follows from n / s + 1 / s' = 1 / f, with distances from the principal planes.
TEST(LensFiles, APointInWaterIsImagedByItsReducedDistance) {
  std::string const near = changed(zmx, "DISZ INFINITY", "DISZ 400.0\n  GLAS ___BLANK 1 0 1.333 0");
  Lens const lens = lens_of_text("near_in_water.zmx", near);
  ParaxialLens const paraxial = paraxial_lens(lens);
  Lens focused = lens;
  focused.image_distance.reset();
  double const f = paraxial.effective_focal_length, s = 0.4 + paraxial.front_principal_plane;
  EXPECT_NEAR(analyse_field(focused, paraxial, 16).image_plane, paraxial.rear_principal_plane + 1 / (1 / f - 1.333 / s),
              1e-13);
}

// Media behind the image do not deflect rays.
TEST(LensFiles, TheImageMayHaveGlassBehindIt) {
  double const glass = bk7();
  EXPECT_NEAR(focal_length_mm(lens_of_case("glass_behind_the_image.zmx")),
              traced_focal_length({0.02, -0.02}, {1, glass, 1}, {5}), 1e-7);
}

// An obscuring disc as large as the surface's drawn semi-diameter: light passes outside.
TEST(LensFiles, AnObscurationMayFillItsSurface) {
  Lens const lens = lens_of_case("obscuration_fills_its_surface.zmx");
  EXPECT_EQ(fate(lens, {0, 1.9}), RayStatus::vignetted);
  EXPECT_EQ(fate(lens, {0, 2.1}), RayStatus::alive);
  EXPECT_THAT(lens.warnings, Contains(Warns("assumed at obscuration_fills_its_surface.zmx:20")));
  EXPECT_NEAR(focal_length_mm(lens), traced_focal_length({0.02, -0.02}, {1, bk7(), 1}, {5}), 1e-7);
}

// R = 30 mm, 1.5 mm thick: the faces meet at a height of 6.65 mm, outside of the beam of 6 mm; their edges are at 12
// mm.
TEST(LensFiles, DrawnEdgesMayOverlapOutsideTheLight) {
  Lens const lens = lens_of_case("drawn_edges_overlap.zmx");
  EXPECT_NEAR(focal_length_mm(lens), traced_focal_length({1 / 30.0, -1 / 30.0}, {1, 1.62041, 1}, {1.5}), 1e-10);
  EXPECT_NEAR(focal_length_mm(lens), 24.411219, 5e-7);
  EXPECT_THAT(lens.warnings, Contains(Warns("inconsistent at drawn_edges_overlap.zmx:19")));
}

TEST(LensFiles, ASurfaceMayEndWithinItsSemiDiameter) {
  Lens const lens = lens_of_text("short.zmx", changed(zmx, "CURV 0.02", "CURV 0.2"));
  EXPECT_THAT(lens.warnings, Contains(Warns("inconsistent at short.zmx:15")));
  EXPECT_EQ(fate(lens, {0, 5.5}), RayStatus::missed_lens);
}

// XASPHERE: a conic and 1.2e-3 (r/10)^4 - 4e-5 (r/10)^6, without a term of r^2, so that the focal length is that of the
// doublet.
TEST(LensFiles, ExtendedEvenAspheresAreNormalisedByARadius) {
  Lens const lens = lens_of_case("extended_even_asphere.zmx");
  EXPECT_NEAR(focal_length_mm(lens), doublet_focal_length(), 1e-10);
  for (double const r : {1.0, 4.0, 7.5}) {
    double const u = r / 10;
    EXPECT_NEAR(sag_of_first_surface(lens, r), sphere_sag(0.016, r) + 1.2e-3 * std::pow(u, 4) - 4e-5 * std::pow(u, 6),
                1e-15);
  }
}

// XOSPHERE: a conic and 1e-3 (r/10)^3 + 2e-3 (r/10)^4.
TEST(LensFiles, ExtendedOddAspheresAreNormalisedByARadius) {
  Lens const lens = lens_of_case("extended_odd_asphere.zmx");
  EXPECT_NEAR(focal_length_mm(lens), doublet_focal_length(), 1e-10);
  for (double const r : {1.0, 4.0, 7.5}) {
    double const u = r / 10;
    EXPECT_NEAR(sag_of_first_surface(lens, r), sphere_sag(0.016, r) + 1e-3 * u * u * u + 2e-3 * u * u * u * u, 1e-15);
  }
}

// ODDASPHE: a conic and 1e-6 r^3 + 2e-7 r^4. A term of r^2 adds twice its coefficient to the vertex curvature.
TEST(LensFiles, OddAspheresAddPowersOfR) {
  Lens const lens = lens_of_case("odd_asphere.zmx");
  EXPECT_NEAR(focal_length_mm(lens), doublet_focal_length(), 1e-10);
  for (double const r : {1.0, 4.0, 7.5}) {
    EXPECT_NEAR(sag_of_first_surface(lens, r), sphere_sag(0.016, r) + 1e-6 * r * r * r + 2e-7 * r * r * r * r, 1e-15);
  }
  std::string const model = changed(zmx, "GLAS N-BK7 0 0 1.5 40", "GLAS ___BLANK 1 0 1.5 0");
  std::string const odd = changed(model, "TYPE STANDARD\n  CURV 0.02", "TYPE ODDASPHE\n  PARM 2 0.001\n  CURV 0.02");
  EXPECT_NEAR(focal_length_mm(lens_of_text("square.zmx", odd)), traced_focal_length({0.022, -0.02}, {1, 1.5, 1}, {6}),
              1e-10);
}

// PARAXIAL: all rays of a parallel bundle, on either side of the axis, cross the axis in the focus.
TEST(LensFiles, AnIdealLensHasNoAberration) {
  Lens const lens = lens_of_case("ideal_lens.zmx");
  EXPECT_NEAR(focal_length_mm(lens), 100, 1e-12);
  for (double const height : {-5.0, 1.0, 5.9}) {
    Ray<double> ray = parallel_ray(height);
    ASSERT_EQ(carry(lens, ray), RayStatus::alive);
    EXPECT_NEAR(height_behind(lens, ray, 100), 0, 1e-13);
  }
  EXPECT_EQ(refusal("flat.zmx", changed(zmx, "TYPE STANDARD\n  CURV 0.02", "TYPE PARAXIAL\n  PARM 1 0\n  CURV 0.02")),
            "out_of_range at flat.zmx:15");
}

// Light that travels back from a mirror is focused as well: an ideal lens of 100 mm, 30 mm behind a flat mirror.
TEST(LensFiles, AnIdealLensFocusesLightThatRunsBack) {
  Lens const lens = lens_of_text(
      "back.zmx",
      "MODE SEQ\nUNIT MM\nENPD 10\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0\n  DISZ -30\n  GLAS MIRROR 0 0\n"
      "SURF 2\n  TYPE PARAXIAL\n  PARM 1 100\n  DISZ -100\nSURF 3\n  DISZ 0\n");
  EXPECT_NEAR(focal_length_mm(lens), 100, 1e-12);
  Ray<double> ray = parallel_ray(4);
  ASSERT_EQ(carry(lens, ray), RayStatus::alive);
  EXPECT_NEAR(height_behind(lens, ray, -100), 0, 1e-13);
}

// TILTSURF: a plane z = 0.1 y at the end of glass of 1.5 deviates the axial ray by asin(1.5 sin a) - a, tan a = 0.1;
// the frame of the next surface is not tilted.
TEST(LensFiles, ATiltedSurfaceIsAPrism) {
  Lens const lens = lens_of_case("tilted_surface.zmx");
  Ray<double> ray = parallel_ray(0);
  ASSERT_EQ(carry(lens, ray), RayStatus::alive);
  double const a = std::atan(0.1);
  EXPECT_NEAR(ray.direction.y, std::sin(std::asin(1.5 * std::sin(a)) - a), 1e-15);
  EXPECT_EQ(lens.poses.back().z.z, 1);
  EXPECT_NEAR(focal_length_mm(lens), 200, 1e-11);
}

// SQAP 6 6: a square of 12 mm; light passes in its corners, but not outside of the square.
TEST(LensFiles, RectangularAperturesAreTraced) {
  Lens const lens = lens_of_case("square_aperture.zmx");
  EXPECT_NEAR(focal_length_mm(lens), doublet_focal_length(), 1e-10);
  EXPECT_EQ(fate(lens, {5.5, 5.5}), RayStatus::alive);
  EXPECT_EQ(fate(lens, {6.1, 0}), RayStatus::vignetted);
  EXPECT_EQ(fate(lens, {0, -6.1}), RayStatus::vignetted);
  EXPECT_THAT(lens.prescription.warnings, IsEmpty());
  auto const by = [](std::string const& operand) {
    return lens_of_text("outline.zmx", changed(zmx, "  STOP\n", "  STOP\n  " + operand + "\n"));
  };
  Lens const blocked = by("SQOB 1 2 0"), ellipse = by("ELAP 2 1 0"), oval = by("ELOB 2 1 0");
  EXPECT_EQ(fate(blocked, {0.9, 1.9}), RayStatus::vignetted);
  EXPECT_EQ(fate(blocked, {1.1, 0}), RayStatus::alive);
  EXPECT_EQ(fate(ellipse, {1.9, 0}), RayStatus::alive);
  EXPECT_EQ(fate(ellipse, {1.5, 0.8}), RayStatus::vignetted);
  EXPECT_EQ(fate(oval, {1.9, 0}), RayStatus::vignetted);
  EXPECT_EQ(fate(oval, {1.5, 0.8}), RayStatus::alive);
  Lens const codev = lens_of_text("outline.seq", changed(seq, "CIR 8.0", "REX 2; REY 1; ADY 0.5"));
  EXPECT_EQ(fate(codev, {1.9, 1.4}), RayStatus::alive);
  EXPECT_EQ(fate(codev, {0, -0.6}), RayStatus::vignetted);
}

// A circle of 3 mm about (2, 0); the spider across it is ignored.
TEST(LensFiles, DecentredAperturesAreTracedAndSpidersPassedOver) {
  Lens const lens = lens_of_case("decentred_apertures.zmx");
  EXPECT_EQ(fate(lens, {4.9, 0}), RayStatus::alive);
  EXPECT_EQ(fate(lens, {-1.1, 0}), RayStatus::vignetted);
  EXPECT_EQ(fate(lens, {2, 2.9}), RayStatus::alive);
  EXPECT_THAT(lens.warnings, Contains(testing::Field(&Warning::text, HasSubstr("SPID"))));
}

TEST(LensFiles, WithoutAStopTheFirstSurfaceIsIt) {
  Lens const codev = lens_of_case("no_stop_named.seq");
  EXPECT_NEAR(focal_length_mm(codev), doublet_focal_length(), 1e-10);
  EXPECT_EQ(codev.stop, 0);
  EXPECT_THAT(codev.warnings, Contains(Warns("assumed at no_stop_named.seq:8")));
  Lens const zemax = lens_of_text("no_stop.zmx", changed(zmx, "  STOP\n", ""));
  EXPECT_EQ(zemax.stop, 0);
  EXPECT_THAT(zemax.warnings, Contains(Warns("assumed at no_stop.zmx:15")));
}

TEST(LensFiles, WithoutAnApertureTheStopsSemiDiameterIsIt) {
  Lens const lens = lens_of_text("open.zmx", changed(zmx, "ENPD 6.0\n", ""));
  EXPECT_NEAR(paraxial_lens(lens).entrance.diameter, 16e-3, 1e-15);
  EXPECT_THAT(lens.warnings, Contains(Warns("assumed at open.zmx:14")));
}

TEST(LensFiles, CodeVMayBeWrittenInLowerCase) {
  Lens const lens = lens_of_case("lower_case.seq");
  EXPECT_NEAR(focal_length_mm(lens), doublet_focal_length(), 1e-10);
  EXPECT_TRUE(std::isinf(lens.prescription.object_distance));
}

// PRV: at a wavelength of the table, its index; between them, Cauchy's polynomial in 1/lambda^2 through the three
// values.
TEST(LensFiles, PrivateGlassesAreInterpolated) {
  Lens const lens = lens_of_case("private_glass.seq");
  EXPECT_NEAR(focal_length_mm(lens), doublet_focal_length(), 1e-10);
  EXPECT_NEAR(focal_length_mm(lens), 75.945, 5e-4);
  Prescription const read = read_prescription(case_path("private_glass.seq"));
  Glass const& glass = std::get<PrescribedMedium::Private>(read.surfaces[0].after.is).glass;
  EXPECT_NEAR(glass.index(486.1327e-9), 1.62757, 1e-15);
  auto const x = [](double micrometres) { return 1 / (micrometres * micrometres); };
  double const at = x(0.55), a = x(0.6563), b = x(0.5875618), c = x(0.4861327);
  double const expected = 1.61727 * (at - b) * (at - c) / ((a - b) * (a - c)) +
                          1.62041 * (at - a) * (at - c) / ((b - a) * (b - c)) +
                          1.62757 * (at - a) * (at - b) / ((c - a) * (c - b));
  EXPECT_NEAR(glass.index(550e-9), expected, 1e-14);
  EXPECT_EQ(refusal("far.seq", changed(changed(seq, "SO 0.0", "PRV\nPWL 700 600\n'own' 1.5 1.51\nEND\nSO 0.0"),
                                       "NBK7_SCHOTT", "'own'")),
            "out_of_range at far.seq:12");
  // Laurent's series is identical to Schott's formula: n^2 = 2.25 at all wavelengths
  Lens const laurent = lens_of_text(
      "laurent.seq", changed(changed(seq, "SO 0.0", "prv\n'own' LAU 2.25 0 0\nend\nSO 0.0"), "NBK7_SCHOTT", "'own'"));
  EXPECT_NEAR(focal_length_mm(laurent), traced_focal_length({0.02, -0.02}, {1, 1.5, 1}, {6}), 1e-10);
}

// CUF 0, terms up to J that are 0, and one of r^4: 1e-7 r^4 [mm].
TEST(LensFiles, CodeVsAsphericTermsGoToJ) {
  Lens const lens = lens_of_case("aspheric_terms.seq");
  EXPECT_NEAR(focal_length_mm(lens), doublet_focal_length(), 1e-10);
  EXPECT_NEAR(sag_of_first_surface(lens, 5), sphere_sag(0.016, 5) + 1e-7 * 625, 1e-15);
  std::string const letters = "ABCDEFGHJ";  // r^4, r^6, ... r^20
  for (std::size_t i = 0; i < letters.size(); ++i) {
    double const power = 4 + 2 * static_cast<double>(i), term = 1e-3 / std::pow(5, power);
    Lens const one = lens_of_text("one.seq", changed(seq, "STO;", fmt::format("STO; {} {:.17g};", letters[i], term)));
    EXPECT_NEAR(sag_of_first_surface(one, 5), sphere_sag(0.02, 5) + 1e-3, 1e-15) << letters[i];
  }
  Lens const high = lens_of_text("high.seq", changed(seq, "STO;", "STO; J 1e-20; A 1e-7;"));
  EXPECT_NEAR(sag_of_first_surface(high, 5), sphere_sag(0.02, 5) + 1e-7 * 625 + 1e-20 * std::pow(5, 20), 1e-15);
  EXPECT_EQ(refusal("cuf.seq", changed(seq, "STO;", "STO; CUF 0.1;")), "unsupported at cuf.seq:9");
}

// DAR: the surface at 12 mm is decentred by 1 mm and tilted by 30 degrees, and the next one is on the axis at 32 mm.
// BEN: a mirror at 45 degrees rotates light and axis by 90 degrees. REV: what follows is rotated back by 90 degrees.
TEST(LensFiles, CodeVsDecentresReturnBendAndReverse) {
  Lens const lens = lens_of_case("decentres.seq");
  auto const expect_place = [&](std::size_t i, Vec3d place_mm, Vec3d axis) {
    EXPECT_LT(length(lens.poses[i].origin - unit::millimetre * place_mm), 1e-15) << i;
    EXPECT_LT(length(lens.poses[i].z - axis), 1e-15) << i;
  };
  double const half = std::sqrt(0.5);
  expect_place(2, {0, 1, 12}, {0, 0.5, std::sqrt(0.75)});
  expect_place(3, {0, 0, 32}, {0, half, half});
  expect_place(4, {0, -20, 32}, {0, 1, 0});
  expect_place(5, {0, -20, 32}, {0, 0, 1});
  ASSERT_TRUE(lens.image_distance);
  EXPECT_NEAR(*lens.image_distance, -30e-3, 1e-16);
  EXPECT_NEAR(focal_length_mm(lens), 200, 1e-10);
  Ray<double> ray = parallel_ray(0);
  ASSERT_EQ(carry(lens, ray), RayStatus::alive);
  EXPECT_LT(length(ray.direction - Vec3d{0, -1, 0}), 1e-15);
}

// A single tilt or decentre ahead of the second face of the singlet: right-handed about x, y and z in a coordinate
// break of Zemax and in TOML, left-handed about x and y in CODE V. Two tilts are about the successively rotated axes.
TEST(LensFiles, EachTiltAndDecentreAloneIsTheSameInEveryFormat) {
  struct Break {
    char const *of_toml, *of_zmx, *of_seq;
    Vec3d origin_mm, x, z;
  };
  double const s = std::sin(20 * unit::degree), c = std::cos(20 * unit::degree), s10 = std::sin(10 * unit::degree),
               c10 = std::cos(10 * unit::degree);
  Vec3d const vertex{0, 0, 6}, x{1, 0, 0}, z{0, 0, 1};
  for (Break const& one : {Break{"decentre_mm = [1.5, 0]", "PARM 1 1.5", "XDE 1.5", {1.5, 0, 6}, x, z},
                           Break{"decentre_mm = [0, -1.5]", "PARM 2 -1.5", "YDE -1.5", {0, -1.5, 6}, x, z},
                           Break{"tilt_deg = [20, 0, 0]", "PARM 3 20", "ADE -20", vertex, x, {0, -s, c}},
                           Break{"tilt_deg = [0, 20, 0]", "PARM 4 20", "BDE -20", vertex, {c, 0, -s}, {s, 0, c}},
                           Break{"tilt_deg = [0, 0, 20]", "PARM 5 20", "CDE 20", vertex, {c, s, 0}, z},
                           Break{"tilt_deg = [10, 20, 0]",
                                 "PARM 3 10\n  PARM 4 20",
                                 "ADE -10; BDE -20",
                                 vertex,
                                 {c, s10 * s, -c10 * s},
                                 {s, -s10 * c, c10 * c}}}) {
    std::string const block = "SURF 2\n  TYPE COORDBRK\n  " + std::string(one.of_zmx) + "\n  DISZ 0\nSURF 3\n";
    for (Lens const& lens :
         {lens_of_text("alone.toml",
                       changed(toml, "thickness_mm = 0.0", "thickness_mm = 0.0\n" + std::string(one.of_toml))),
          lens_of_text("alone.zmx", changed(changed(zmx, "SURF 3\n", "SURF 4\n"), "SURF 2\n", block)),
          lens_of_text("alone.seq", changed(seq, "SI 0.0", std::string(one.of_seq) + "\nSI 0.0"))}) {
      Pose<double> const& pose = lens.poses[1];
      EXPECT_LT(length(pose.origin - unit::millimetre * one.origin_mm), 1e-15) << lens.prescription.file << one.of_seq;
      EXPECT_LT(length(pose.x - one.x), 1e-15) << lens.prescription.file << ' ' << one.of_seq;
      EXPECT_LT(length(pose.z - one.z), 1e-15) << lens.prescription.file << ' ' << one.of_seq;
    }
  }
}

// A flat mirror behind the singlet is rotated by a single angle of CODE V. ADE 20 turns its normal towards +y and BDE
// 20 towards -x, so that the axial ray is reflected at 40 degrees from the axis to the other side; CDE does not deflect
// it.
TEST(LensFiles, ASingleAngleOfCodeVTurnsAMirror) {
  double const s = std::sin(40 * unit::degree), c = std::cos(40 * unit::degree);
  struct Turned {
    char const* angle;
    Vec3d reflected;
  };
  for (Turned const& one : {Turned{"ADE 20", {0, -s, -c}}, Turned{"ADE -20", {0, s, -c}}, Turned{"BDE 20", {s, 0, -c}},
                            Turned{"BDE -20", {-s, 0, -c}}, Turned{"CDE 20", {0, 0, -1}}}) {
    Lens const lens =
        lens_of_text("turned.seq", changed(seq, "SI 0.0", "S 0 -10 REFL\n  " + std::string(one.angle) + "\nSI 0.0"));
    Ray<double> ray = parallel_ray(0);
    ASSERT_EQ(carry(lens, ray), RayStatus::alive) << one.angle;
    EXPECT_LT(length(ray.direction - one.reflected), 1e-15) << one.angle;
  }
  // about the axis, CDE rotates a rectangle of 4 x 1 mm in right-handed sense: its long side from +x towards +y
  Lens const lens = lens_of_text("slit.seq", changed(seq, "CIR 8.0", "REX 2; REY 0.5; CDE 30"));
  double const along_x = 1.9 * std::cos(30 * unit::degree), along_y = 1.9 * std::sin(30 * unit::degree);
  EXPECT_EQ(fate(lens, {along_x, along_y}), RayStatus::alive);
  EXPECT_EQ(fate(lens, {along_x, -along_y}), RayStatus::vignetted);
}

// ZDE shifts along the axis, and DAR restores this as well.
TEST(LensFiles, CodeVsShiftAlongTheAxisIsADistance) {
  std::string const text = changed(seq, "SI 0.0", "S 0 10\n ZDE 2\nS 0 10\n ZDE 2; DAR\nS 0 5\nSI 0.0");
  Lens const lens = lens_of_text("zde.seq", text);
  EXPECT_NEAR(lens.poses[2].origin.z, 55e-3, 1e-15);
  EXPECT_NEAR(lens.poses[3].origin.z, 67e-3, 1e-15);
  EXPECT_NEAR(lens.poses[4].origin.z, 75e-3, 1e-15);
}

// Without RDM, numbers are curvatures, CODE V's default. Those of this triplet would be spheres of 0.05 mm with a pupil
// of 10 mm, and are therefore taken as radii. A program that reads radii computes 50.33 mm.
TEST(LensFiles, WithoutRdmNumbersAreCurvaturesUnlessTheyCannotBe) {
  Lens const lens = lens_of_case("without_rdm.seq");
  EXPECT_THAT(lens.warnings, Contains(Warns("assumed at without_rdm.seq:7")));
  auto const index = [](char const* name) {
    return GlassCatalogue::shipped().match(name, 587.6e-9, "").glass->index(587.6e-9);
  };
  double const crown = index("N-SK16"), flint = index("F2");
  double const f =
      traced_focal_length({1 / 22.01359, -1 / 435.7602, -1 / 22.21328, 1 / 20.29192, 1 / 79.68360, -1 / 18.39533},
                          {1, crown, 1, flint, 1, crown, 1}, {3.795568, 6, 2, 4.750246, 2.720573});
  EXPECT_NEAR(f, 50.33, 5e-3);
  EXPECT_NEAR(focal_length_mm(lens), f, 1e-10);
  std::string const curvatures =
      changed(changed(changed(seq, "RDM;LEN", "LEN"), "S 50.0", "S 0.02"), "S -50.0", "S -0.02");
  Lens const plain = lens_of_text("curvatures.seq", curvatures);
  EXPECT_NEAR(focal_length_mm(plain), focal_length_mm(lens_of_text("radii.seq", seq)), 1e-10);
  EXPECT_THAT(plain.warnings, IsEmpty());
}

TEST(LensFiles, CodeVCommandsThatChangeTheSurfaceAreRefusedAndOthersNoted) {
  for (char const* const command : {"GRT", "DIF DOE", "HOE", "SPS XYP", "YTO", "RET S1", "NSS"}) {
    EXPECT_EQ(refusal("refused.seq", changed(seq, "STO;", std::string("STO; ") + command + ";")),
              "unsupported at refused.seq:9")
        << command;
  }
  Lens const lens = lens_of_text("noted.seq", changed(seq, "STO;", "STO; QQQ 1; WWW; QQQ 2;"));
  EXPECT_THAT(lens.warnings, Contains(Warns("ignored at noted.seq:9", HasSubstr("QQQ, WWW"))));
  Lens const hole = lens_of_text("hole.seq", changed(seq, "CIR 8.0", "CIR 8.0; CIR HOL L'A' 2.0"));
  EXPECT_EQ(fate(hole, {0, 1.9}), RayStatus::vignetted);
  EXPECT_EQ(fate(hole, {0, 2.1}), RayStatus::alive);
  EXPECT_THAT(hole.warnings, Contains(Warns("approximated at hole.seq:9")));
}

// CIR on the stop limits an aperture that EPD or FNO would open too far, as CLAP does in a .zmx file: the pupil is 3
// mm, not 6 mm. A drawing (EDG) and a circle off the axis, which is an outline, do not change the pupil.
TEST(LensFiles, AnApertureOnTheStopLimitsTheLens) {
  auto const pupil_mm = [](std::string const& text, char const* name = "stop.seq") {
    return paraxial_lens(lens_of_text(name, text)).entrance.diameter / unit::millimetre;
  };
  EXPECT_NEAR(pupil_mm(seq), 6, 1e-12);
  EXPECT_NEAR(pupil_mm(changed(seq, "CIR 8.0", "CIR 1.5")), 3, 1e-12);
  EXPECT_NEAR(pupil_mm(changed(changed(seq, "EPD 6.0", "FNO 8"), "CIR 8.0", "CIR 1.5")), 3, 1e-12);
  EXPECT_NEAR(pupil_mm(changed(seq, "CIR 8.0", "CIR EDG 1.5")), 6, 1e-12);
  EXPECT_NEAR(pupil_mm(changed(seq, "CIR 8.0", "CIR 1.5; ADX 0.5")), 6, 1e-12);
  EXPECT_NEAR(pupil_mm(changed(zmx, "  STOP\n", "  STOP\n  CLAP 0 1.5 0\n"), "stop.zmx"), 3, 1e-12);
}

// RMD REFL turns any surface into a mirror: R = 50 mm, f = R / 2, as with REFL in place of a glass.
TEST(LensFiles, CodeVsRefractionModeMakesAMirror) {
  std::string const mirror = changed(seq, "S 50.0 6.0 NBK7_SCHOTT", "S -50.0 -6.0 REFL");
  std::string const flat = changed(changed(mirror, "S -50.0 &", "S 0.0 &"), "  47.0", "  -19.0");
  double const f = focal_length_mm(lens_of_text("refl.seq", flat));
  EXPECT_NEAR(std::abs(f), 25, 1e-12);
  std::string const by_mode = changed(flat, " REFL\n", "\n  RMD REFL\n");
  Lens const lens = lens_of_text("rmd.seq", by_mode);
  EXPECT_EQ(focal_length_mm(lens), f);
  EXPECT_THAT(lens.warnings, IsEmpty());
  EXPECT_EQ(focal_length_mm(lens_of_text(
                "named.seq", changed(changed(by_mode, "  RMD REFL\n", ""), "SI 0.0", "RMD S1 REFL\nSI 0.0"))),
            f);
  EXPECT_EQ(focal_length_mm(lens_of_text("refr.seq", changed(seq, "STO;", "STO; RMD REFR;"))),
            focal_length_mm(lens_of_text("plain.seq", seq)));
  EXPECT_EQ(refusal("tir.seq", changed(seq, "STO;", "STO; RMD TIR;")), "unsupported at tir.seq:9");
}

// PIM puts the image at its paraxial position, whatever the last thickness is; the thickness of SI is its defocus.
TEST(LensFiles, CodeVsParaxialImageSolveIsObeyed) {
  auto const image_mm = [](std::string const& text) {
    Lens const lens = lens_of_text("pim.seq", text);
    return analyse_field(lens, paraxial_lens(lens), 16).image_plane / unit::millimetre;
  };
  double const back = paraxial_lens(lens_of_text("pim.seq", seq)).back_focal_length / unit::millimetre;
  EXPECT_GT(std::abs(back - 47), 0.1);
  EXPECT_NEAR(image_mm(seq), 47, 1e-12);
  std::string const solved = changed(seq, "GO\n", "PIM\nGO\n");
  EXPECT_NEAR(image_mm(solved), back, 1e-12);
  EXPECT_NEAR(image_mm(changed(solved, "SI 0.0 0.0", "SI 0.0 -0.5")), back - 0.5, 1e-12);
  EXPECT_THAT(lens_of_text("tilt.seq", changed(solved, "SI 0.0 0.0", "SI 0.0 0.0\n  ADE 5")).warnings,
              Contains(Warns("ignored at tilt.seq:14")));
}

// Vignetting factors do not change the light: each command is listed if any factor differs from 0, several of them in
// one warning.
TEST(LensFiles, VignettingFactorsAreNotUsed) {
  double const f = focal_length_mm(lens_of_text("plain.zmx", zmx));
  auto const of_zemax = [](std::string const& lines) {
    return lens_of_text("factors.zmx", changed(zmx, "PWAV 2", "PWAV 2\n" + lines));
  };
  for (std::string const key : {"VDXN", "VDYN", "VCXN", "VCYN", "VANN", "VDXD", "VDYD", "VCXD", "VCYD"}) {
    Lens const lens = of_zemax(key + " 0 0.2 0 0");
    EXPECT_EQ(focal_length_mm(lens), f) << key;
    EXPECT_THAT(lens.warnings, ElementsAre(Warns("ignored at factors.zmx:11", HasSubstr(key))));
    EXPECT_THAT(of_zemax(key + " 0 0 0 0").warnings, IsEmpty()) << key;
  }
  EXPECT_THAT(of_zemax("VDXN 0 0.1\nVDYN 0 0.1\nVCXN 0 0.2\nVCYN 0 0.2\nVANN 0 0").warnings,
              ElementsAre(Warns("ignored at factors.zmx:11")));
  for (std::string const key : {"VUX", "VLX", "VUY", "VLY"}) {
    auto const of_codev = [&](std::string const& factors) {
      return lens_of_text("factors.seq", changed(seq, "REF 2", "REF 2\n" + key + factors)).warnings;
    };
    EXPECT_THAT(of_codev(" 0 0.2"), ElementsAre(Warns("ignored at factors.seq:7", HasSubstr(key))));
    EXPECT_THAT(of_codev(" 0 0"), IsEmpty()) << key;
  }
}

// Fields of CODE V that are not angles in the y-z plane.
TEST(LensFiles, CodeVsOtherFieldsAreNamed) {
  for (std::string const key : {"XAN", "XOB", "YOB", "XIM", "YIM", "XRI", "YRI"}) {
    auto const warnings = [&](std::string const& fields) {
      return lens_of_text("fields.seq", changed(seq, "REF 2", "REF 2\n" + key + fields)).warnings;
    };
    EXPECT_THAT(warnings(" 0 3"), ElementsAre(Warns("ignored at fields.seq:7", HasSubstr(key))));
    EXPECT_THAT(warnings(" 0 0"), IsEmpty()) << key;
  }
}

TEST(LensFiles, WithoutAnImageTheLastThicknessLeadsToIt) {
  Lens const lens = lens_of_text("open.seq", changed(seq, "SI 0.0 0.0\n", ""));
  EXPECT_THAT(lens.warnings, ElementsAre(Warns("incomplete at open.seq:10")));
  EXPECT_NEAR(analyse_field(lens, paraxial_lens(lens), 16).image_plane / unit::millimetre, 47, 1e-12);
}

// Indices are those of the catalogue, at 20 degrees C and 760 mmHg.
TEST(LensFiles, CodeVsTemperatureAndPressureAreNoted) {
  EXPECT_THAT(lens_of_text("usual.seq", changed(seq, "REF 2", "REF 2\nTEM 20.0\nPRE 760.0")).warnings, IsEmpty());
  EXPECT_THAT(lens_of_text("hot.seq", changed(seq, "REF 2", "REF 2\nTEM 40\nPRE 500")).warnings,
              ElementsAre(Warns("ignored at hot.seq:7"), Warns("ignored at hot.seq:8")));
}

TEST(LensFiles, PrivateGlassesNeedAnIndexForEveryWavelengthAndAnEnd) {
  auto const with = [](std::string const& glasses) {
    return changed(changed(seq, "SO 0.0", glasses + "SO 0.0"), "NBK7_SCHOTT", "'own'");
  };
  EXPECT_EQ(refusal("few.seq", with("PRV\nPWL 656.3 587.6 486.1\n'own' 1.5 1.51\nEND\n")), "wrong_shape at few.seq:9");
  EXPECT_EQ(refusal("many.seq", with("PRV\nPWL 587.6\n'own' 1.5 1.51\nEND\n")), "wrong_shape at many.seq:9");
  EXPECT_EQ(refusal("endless.seq", with("PRV\nPWL 656.3 486.1\n'own' 1.5 1.51\n")), "syntax at endless.seq:7");
  EXPECT_EQ(refusal("cut.seq", "RDM\nPRV\nPWL 656.3 486.1\n"), "syntax at cut.seq:2");
}

// The unit of length may be in lower case.
TEST(LensFiles, UnitsMayBeInLowerCase) {
  EXPECT_EQ(focal_length_mm(lens_of_text("lower.zmx", changed(zmx, "UNIT MM", "UNIT mm"))),
            focal_length_mm(lens_of_text("upper.zmx", zmx)));
  EXPECT_NEAR(focal_length_mm(lens_of_text("lower.zmx", changed(zmx, "UNIT MM", "UNIT cm"))),
              10 * focal_length_mm(lens_of_text("upper.zmx", zmx)), 1e-10);
}

/// A lens file with the commands of a row of the documented table, and a number that is correct only if they are
/// obeyed.
struct CommandRow {
  char const* commands;
  std::string text;
  std::function<double(Lens const&)> measure;
  double expected;
};
void expect_rows(std::string const& name, std::vector<CommandRow> const& rows) {
  for (CommandRow const& row : rows)
    EXPECT_NEAR(row.measure(lens_of_text(name, row.text)), row.expected, 1e-9) << row.commands;
}

// Rows of the documented table that no other test covers, each with a number that is correct only if its commands are
// obeyed.
TEST(LensFiles, TheDocumentedCodeVCommandsAreObeyed) {
  auto const with = [](std::string const& from, std::string const& to) { return changed(seq, from, to); };
  auto const on_stop = [&](std::string const& commands) { return with("CIR 8.0", commands); };
  auto const light_at = [](double x, double y) {
    return [x, y](Lens const& lens) { return fate(lens, {x, y}) == RayStatus::alive ? 1.0 : 0.0; };
  };
  auto const pupil_mm = [](Lens const& lens) { return paraxial_lens(lens).entrance.diameter / unit::millimetre; };
  auto const warnings_with = [](std::string const& word) {
    return [word](Lens const& lens) {
      return static_cast<double>(std::count_if(lens.warnings.begin(), lens.warnings.end(), [&](auto const& warning) {
        return warning.text.find(word) != std::string::npos;
      }));
    };
  };
  auto const focal_length = [](Lens const& lens) { return focal_length_mm(lens); };
  auto const image_mm = [](Lens const& lens) {
    return analyse_field(lens, paraxial_lens(lens), 16).image_plane / unit::millimetre;
  };
  double const f = traced_focal_length({0.02, -0.02}, {1, bk7(), 1}, {6});
  std::string const curvatures =
      changed(changed(with("RDM;LEN", "RDM N;LEN"), "S 50.0", "S 0.02"), "S -50.0", "S -0.02");
  std::vector<CommandRow> const rows{
      {"RDM", seq, focal_length, f},
      {"RDM N", curvatures, focal_length, f},
      {"517.642", with("NBK7_SCHOTT", "517.642"), focal_length, traced_focal_length({0.02, -0.02}, {1, 1.517, 1}, {6})},
      {"FNO", with("EPD 6.0", "FNO 9"), pupil_mm, f / 9},
      // the cone of a numerical aperture s has the radius 100 mm s / sqrt(1 - s^2) at the stop, the first surface
      {"NAO", changed(with("EPD 6.0", "NAO 0.02"), "SO 0.0 1e13", "SO 0.0 100"), pupil_mm,
       200 * 0.02 / std::sqrt(1 - 0.0004)},
      {"CIR", with("  47.0", "  47.0\n  CIR 2"), light_at(0, 3), 0},
      {"CIR EDG", with("  47.0", "  47.0\n  CIR EDG 2"), light_at(0, 3), 1},
      {"CIR OBS", on_stop("CIR OBS 2"), light_at(0, 1.9), 0},
      {"ELX, ELY: the long axis", on_stop("ELX 2; ELY 1"), light_at(1.9, 0), 1},
      {"ELX, ELY: the short axis", on_stop("ELX 2; ELY 1"), light_at(0, 1.1), 0},
      {"ELX, ELY: the corner", on_stop("ELX 2; ELY 1"), light_at(1.5, 0.8), 0},
      {"REX, REY: the corner", on_stop("REX 2; REY 1"), light_at(1.5, 0.8), 1},
      {"ELX OBS, ELY OBS", on_stop("ELX OBS 2; ELY OBS 1"), light_at(1.9, 0), 0},
      {"ADX, ADY: the new centre", on_stop("REX 1; REY 1; ADX 3; ADY -2"), light_at(3.5, -2.5), 1},
      {"ADX, ADY: the axis", on_stop("REX 1; REY 1; ADX 3; ADY -2"), light_at(0, 0), 0},
      {"ARO", on_stop("REX 1; REY 2; ARO 45"), warnings_with("ARO"), 1},
      {"ARO 0", on_stop("REX 1; REY 2; ARO 0"), warnings_with("ARO"), 0},
      {"ZOO", with("REF 2", "REF 2\nZOO 3"), warnings_with("ZOO"), 1},
      {"VUX", with("REF 2", "REF 2\nVUX 0.1 0"), warnings_with("VUX"), 1},
      {"VUX 0", with("REF 2", "REF 2\nVUX 0 0"), warnings_with("VUX"), 0},
      {"K", with("STO;", "STO; K -0.5;"), [](Lens const& lens) { return sag_of_first_surface(lens, 4); },
       0.02 * 16 / (1 + std::sqrt(1 - 0.5 * 0.02 * 0.02 * 16))},
      {"REX HOL, REY HOL", on_stop("REX HOL 2; REY HOL 1"), light_at(1.9, 0.9), 0},
      {"REX HOL, REY HOL: outside", on_stop("REX HOL 2; REY HOL 1"), light_at(1.9, 1.1), 1},
      {"STOP 2", changed(with("  STO; CIR 8.0\n", ""), "GO\n", "STOP 2\nGO\n"),
       [](Lens const& lens) { return static_cast<double>(lens.stop); }, 1},
      {"1.5168:64.2", with("NBK7_SCHOTT", "1.5168:64.2"), focal_length,
       traced_focal_length({0.02, -0.02}, {1, 1.5168, 1}, {6})},
      {"1.5:0", with("NBK7_SCHOTT", "1.5:0"), focal_length, traced_focal_length({0.02, -0.02}, {1, 1.5, 1}, {6})},
      {"SO in water", with("SO 0.0 1e13", "SO 0.0 1e13 1.333:0"), focal_length,
       traced_focal_length({0.02, -0.02}, {1.333, bk7(), 1}, {6})},
      {"WL without REF: the middle one", with("WL 486.1 587.5618\nREF 2\n", "WL 656.3 546.1 486.1\n"),
       [](Lens const& lens) { return lens.prescription.primary_wavelength / unit::nanometre; }, 546.1},
      {"NAO of an object at infinity: the stop's semi-diameter", with("EPD 6.0", "NAO 0.1"), pupil_mm, 16},
      {"SI: the defocus", with("SI 0.0 0.0", "SI 0.0 -0.5"), image_mm, 46.5},
      {"DIM C", with("DIM M", "DIM C"), focal_length, 10 * f},
      {"DIM I", with("DIM M", "DIM I"), focal_length, 25.4 * f},
  };
  expect_rows("row.seq", rows);
}

// Like above, for Zemax files.
TEST(LensFiles, TheDocumentedZemaxCommandsAreObeyed) {
  auto const with = [](std::string const& from, std::string const& to) { return changed(zmx, from, to); };
  auto const focal_length = [](Lens const& lens) { return focal_length_mm(lens); };
  double const f = traced_focal_length({0.02, -0.02}, {1, bk7(), 1}, {6});
  std::string const aspheric = with("  STOP\n  TYPE STANDARD\n",
                                    "  STOP\n  TYPE EVENASPH\n  CONI -0.5\n  PARM 1 0\n  PARM 2 1e-4\n  PARM 3 2e-6\n");
  double const r = 4, conic_sag = 0.02 * r * r / (1 + std::sqrt(1 - 0.5 * 0.02 * 0.02 * r * r));
  std::string metres = with("UNIT MM", "UNIT METER");
  for (auto const& [from, to] : {std::pair{"ENPD 6.0", "ENPD 0.006"},
                                 {"CURV 0.02", "CURV 20"},
                                 {"DISZ 6.0", "DISZ 0.006"},
                                 {"DIAM 8.0", "DIAM 0.008"},
                                 {"CURV -0.02", "CURV -20"},
                                 {"DISZ 47.0", "DISZ 0.047"},
                                 {"DIAM 8.0", "DIAM 0.008"}}) {
    metres = changed(metres, from, to);
  }
  std::vector<CommandRow> const rows{
      {"EVENASPH", aspheric, [r](Lens const& lens) { return sag_of_first_surface(lens, r); },
       conic_sag + 1e-4 * std::pow(r, 4) + 2e-6 * std::pow(r, 6)},
      {"STANDARD with CONI", with("  CURV 0.02", "  CONI -0.5\n  CURV 0.02"),
       [r](Lens const& lens) { return sag_of_first_surface(lens, r); }, conic_sag},
      {"UNIT IN", with("UNIT MM", "UNIT IN"), focal_length, 25.4 * f},
      {"UNIT METER", metres, focal_length, f},
      {"GLAS with flag 1: a model glass, whatever its name", with("GLAS N-BK7 0 0 1.5 40", "GLAS OTHER 1 0 1.6 0"),
       focal_length, traced_focal_length({0.02, -0.02}, {1, 1.6, 1}, {6})},
      {"DISZ of the last surface: the image", zmx,
       [](Lens const& lens) { return analyse_field(lens, paraxial_lens(lens), 16).image_plane / unit::millimetre; },
       47},
      {"GLAS MIRROR", changed(with("DISZ 6.0", "DISZ -6.0"), "GLAS N-BK7 0 0 1.5 40", "GLAS MIRROR 0 0"),
       [](Lens const& lens) { return std::abs(focal_length_mm(lens)); }, 25},
      {"FLOA: the stop's semi-diameter", with("ENPD 6.0", "FLOA"),
       [](Lens const& lens) { return paraxial_lens(lens).entrance.diameter / unit::millimetre; }, 16},
      {"WAVL", changed(with("WAVM 1 0.48613270 1\n", ""), "WAVM 2 0.58756180 1", "WAVL 0.4861327 0.5875618"),
       [](Lens const& lens) { return lens.prescription.primary_wavelength / unit::nanometre; }, 587.5618},
  };
  expect_rows("row.zmx", rows);
}

TEST(LensFiles, GratingsAndOtherSurfacesAreRefusedByName) {
  for (char const* const type : {"DGRATING", "GRINSUR1", "BIREFRIN", "NONSEQCO", "BINARY_2", "TOROIDAL", "FZERNSAG"}) {
    EXPECT_EQ(refusal("type.zmx",
                      changed(zmx, "TYPE STANDARD\n  CURV -0.02", std::string("TYPE ") + type + "\n  CURV -0.02")),
              "unsupported at type.zmx:23")
        << type;
  }
}

// Two manufacturers have a glass of the same name: that of the catalogue listed in the file is used, else the first in
// the documented order.
TEST(LensFiles, TheFilesCatalogueIsThatOfAGlassOfSeveral) {
  GlassCatalogue glasses;
  glasses.add("NM SF1 1 0 1.5 60\nCD 2.25\nLD 0.3 2\n", "OHARA", "ohara.agf");
  glasses.add("NM SF1 1 0 1.71736 29.5\nCD 2.9493254\nLD 0.3 2\n", "SCHOTT_2020", "schott_2020.agf");
  double const schott = traced_focal_length({0.02, -0.02}, {1, std::sqrt(2.9493254), 1}, {5});
  Lens const named = lens_of_case("glass_in_two_catalogues.zmx", glasses);
  EXPECT_NEAR(focal_length_mm(named), schott, 1e-10);
  EXPECT_THAT(named.warnings, IsEmpty());
  Prescription other = read_prescription(case_path("glass_in_two_catalogues.zmx"));
  other.catalogues = {"OHARA"};
  EXPECT_NEAR(focal_length_mm(build_lens(other, glasses, spectral_line::d)),
              traced_focal_length({0.02, -0.02}, {1, 1.5, 1}, {5}), 1e-10);
  other.catalogues.clear();
  Lens const assumed = build_lens(other, glasses, spectral_line::d);
  EXPECT_NEAR(focal_length_mm(assumed), schott, 1e-10);
  EXPECT_THAT(assumed.warnings,
              ElementsAre(Warns("assumed at glass_in_two_catalogues.zmx:18", HasSubstr("OHARA:SF1"))));
}

// A usable glass, one with an index below 1, and one without a range of wavelengths.
TEST(LensFiles, ACatalogueWithAnInvalidGlassRemainsUsable) {
  GlassCatalogue glasses;
  glasses.add_file(case_path("good_and_odd_glass.agf"));
  ASSERT_EQ(glasses.glasses().size(), 1u);
  EXPECT_NEAR(glasses.match("GOODCROWN", spectral_line::d, "").glass->nd(), std::sqrt(2.5571), 1e-15);
  EXPECT_THAT(glasses.warnings(),
              ElementsAre(Warns("ignored at good_and_odd_glass.agf:5",
                                AllOf(HasSubstr("ODDGLASS (line 5"), HasSubstr("NORANGE (line 8")))));
  EXPECT_EQ(error_of([&] { glasses.match("NORANGE", spectral_line::d, "lens:1"); }), "invalid_value at lens:1");
}

// Coefficients that continue on the next line define the same glass, nd 2.00069, and hence the same lens.
TEST(LensFiles, WrappedLinesOfACatalogueAreJoined) {
  GlassCatalogue wrapped, whole;
  wrapped.add_file(case_path("wrapped_lines.agf"));
  whole.add_file(case_path("whole_lines.agf"));
  EXPECT_NEAR(wrapped.match("J-LASFH17", spectral_line::d, "").glass->nd(), 2.00069, 5e-6);
  Lens const lens = lens_of_case("glass_of_wrapped_lines.zmx", wrapped);
  EXPECT_EQ(focal_length_mm(lens), focal_length_mm(lens_of_case("glass_of_wrapped_lines.zmx", whole)));
  EXPECT_THAT(lens.warnings, IsEmpty());
}

// Every kind of line that may be continued by a line of numbers.
TEST(LensFiles, EveryLineOfNumbersOfACatalogueMayBeWrapped) {
  GlassCatalogue glasses;
  glasses.add(
      "NM X 1 0 1.5 60\nED 7 0\n0 0\nCD 2\n0.25 0\nTD 0\n0 0\nOD 1\n2\nLD 0.3\n2\nIT 0.4 0.9\n10\nIT 0.5\n0.99 10\n",
      "OWN", "own.agf");
  Glass const& glass = *glasses.match("X", 1e-6, "").glass;
  EXPECT_NEAR(glass.index(1e-6), 1.5, 1e-15) << "n^2 = 2 + 0.25 lambda^2 at 1 um";
  EXPECT_NEAR(glass.shortest, 0.3e-6, 1e-20);
  EXPECT_NEAR(glass.longest, 2e-6, 1e-20);
  ASSERT_EQ(glass.transmission.size(), 2u);
  EXPECT_NEAR(glass.transmission[0].thickness, 10e-3, 1e-15);
  EXPECT_EQ(glass.transmission[1].transmission, 0.99);
  EXPECT_THAT(glasses.warnings(), IsEmpty());
}

// A glass without coefficients, one without a range, one of an unknown formula, and one with an impossible index.
TEST(LensFiles, GlassesThatCannotBeUsedAreLeftOutTogether) {
  GlassCatalogue glasses;
  glasses.add(
      "NM GOOD 1 0 1.5 60\nCD 2.25\nLD 0.3 2\nNM EMPTY 1 0 1.5 60\nLD 0.3 2\nNM NORANGE 1 0 1.5 60\nCD 2.25\n"
      "NM NEWER 14 0 1.5 60\nCD 2.25\nLD 0.3 2\nNM DENSE 1 0 1.5 60\nCD 90\nLD 0.3 2\n",
      "OWN", "own.agf");
  EXPECT_EQ(glasses.glasses().size(), 1u);
  EXPECT_THAT(glasses.warnings(), ElementsAre(Warns("ignored at own.agf:4",
                                                    AllOf(HasSubstr("EMPTY (line 4"), HasSubstr("NORANGE (line 6"),
                                                          HasSubstr("NEWER (line 8"), HasSubstr("DENSE (line 11")))));
}

// The catalogue prints nd = 1.6 for n^2 = 2.25, which causes a warning where the glass is used. Printed values of 1 and
// 0 are placeholders, and invalid lines IT are ignored.
TEST(LensFiles, ACatalogueThatContradictsItselfIsWarnedOf) {
  GlassCatalogue glasses;
  glasses.add("NM X 1 0 1.6 50\nCD 2.25\nLD 0.3 2\nIT 0.4 0.9 0\nIT 0.5 0.99 10\nNM Y 1 0 1 0\nCD 2.25\nLD 0.3 2\n",
              "OWN", "own.agf");
  GlassMatch const x = glasses.match("X", spectral_line::d, "lens:1");
  EXPECT_THAT(x.notes,
              ElementsAre(Warns("inconsistent at lens:1", AllOf(HasSubstr("1.500000"), HasSubstr("1.600000")))));
  EXPECT_EQ(x.glass->transmission.size(), 1u);
  EXPECT_THAT(glasses.match("Y", spectral_line::d, "lens:1").notes, IsEmpty());
  EXPECT_THAT(glasses.warnings(), ElementsAre(Warns("ignored at own.agf:4")));
}

// SCHOTT's lead-free glass has the same index as the one that it replaced: 1.5168.
TEST(LensFiles, AnOlderGlassIsItsSuccessor) {
  Lens const lens = lens_of_text("bk7.zmx", changed(zmx, "GLAS N-BK7", "GLAS BK7"));
  EXPECT_EQ(focal_length_mm(lens), focal_length_mm(lens_of_text("nbk7.zmx", zmx)));
  EXPECT_THAT(lens.warnings, ElementsAre(Warns("assumed at bk7.zmx:20", HasSubstr("N-BK7"))));
}

// A file with the surfaces of the singlet only, without object and image. An index of -1 is a mirror: R = 50 mm, f = R
// / 2.
TEST(LensFiles, OtherProgramsLeaveOutTheObjectOrWriteMirrorsAsIndices) {
  Lens const bare = lens_of_text("bare.zmx",
                                 "MODE SEQ\nUNIT MM\nSURF 1\n  CURV 0.02\n  DISZ 6\n  DIAM 8\n  GLAS ___BLANK 1 0 1.5\n"
                                 "SURF 2\n  CURV -0.02\n  DISZ 47\n  DIAM 8\n");
  EXPECT_NEAR(focal_length_mm(bare), traced_focal_length({0.02, -0.02}, {1, 1.5, 1}, {6}), 1e-10);
  EXPECT_THAT(bare.warnings, Contains(Warns("assumed at bare.zmx:3")));
  std::string const reflecting =
      changed(changed(zmx, "DISZ 6.0", "DISZ -6.0"), "GLAS N-BK7 0 0 1.5 40", "GLAS ___BLANK 1 0 -1 0");
  Lens const mirror = lens_of_text("mirror.zmx", changed(reflecting, "CURV -0.02", "CURV 0"));
  EXPECT_NEAR(std::abs(focal_length_mm(mirror)), 25, 1e-12);
  EXPECT_THAT(mirror.warnings, Contains(Warns("assumed at mirror.zmx:20")));
}

TEST(LensFiles, ConfigurationsEnvironmentAndCurvedImagesAreNotedOnce) {
  std::string const text =
      changed(changed(zmx, "PWAV 2", "PWAV 2\nMNUM 3 1\nENVD 40 1 1"), "SURF 3\n", "SURF 3\n  CURV 0.01\n");
  EXPECT_THAT(lens_of_text("noted.zmx", text).warnings,
              testing::UnorderedElementsAre(Warns("ignored at noted.zmx:11"), Warns("ignored at noted.zmx:12"),
                                            Warns("ignored at noted.zmx:29")));
}

}  // namespace
}  // namespace gladstone
