#include "render/optics/prescription.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "render/base/units.h"
#include "render/optics/paraxial.h"
#include "tests/optics/prescription_texts.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

ParaxialLens paraxial_of(std::string const& name, std::string const& bytes) {
  return paraxial_lens(read_lens(name, bytes));
}

std::string utf16(std::string const& text, bool little) {
  std::string bytes = little ? "\xff\xfe" : "\xfe\xff";
  for (char const c : text) bytes += little ? std::string{c, '\0'} : std::string{'\0', c};
  return bytes;
}

// The six glasses of the lens, two of which are the same, are listed in one warning.
TEST(Prescription, GlassesByIndexAloneAreWarnedOfOnce) {
  Lens const lens = build_lens(read_prescription(std::string(GLADSTONE_DATA_DIR) + "/lenses/wide_angle.toml"),
                               GlassCatalogue::shipped(), spectral_line::d);
  EXPECT_THAT(lens.warnings, ElementsAre(Warns("approximated at wide_angle.toml:13:1",
                                               AllOf(HasSubstr("nd 1.62374, Vd 47.00 (line 13:1); "),
                                                     HasSubstr("nd 1.58913, Vd 61.20 (line ")))));
}

// One lens is read in three formats: the biconvex singlet f = R / (2 (n - 1) - (n - 1)^2 t / (n R)).
TEST(Prescription, OneLensInThreeFormatsIsOneLens) {
  double const n = GlassCatalogue::shipped().match("N-BK7", spectral_line::d, "").glass->nd();
  double const f = 50 / (2 * (n - 1) - (n - 1) * (n - 1) * 6 / (n * 50));
  EXPECT_NEAR(paraxial_of("one.toml", toml).effective_focal_length * 1e3, f, 1e-11);
  EXPECT_NEAR(paraxial_of("one.zmx", zmx).effective_focal_length * 1e3, f, 1e-11);
  EXPECT_NEAR(paraxial_of("one.seq", seq).effective_focal_length * 1e3, f, 1e-11);
  EXPECT_NEAR(paraxial_of("one.toml", toml).f_number, 8, 1e-14);
  EXPECT_NEAR(paraxial_of("one.zmx", zmx).entrance.diameter * 1e3, 6, 1e-13);
  EXPECT_NEAR(paraxial_of("one.seq", seq).entrance.diameter * 1e3, 6, 1e-13);
  EXPECT_EQ(read_prescription(file_of("one.seq", seq)).title, "a singlet; with a semicolon");
  EXPECT_NEAR(read_prescription(file_of("one.zmx", zmx)).primary_wavelength, 587.5618e-9, 1e-16);
}

// Every key of the documented table of our format, in SI: an aspheric term a r^4 of 1e-6 mm^-3 is 1e3 m^-3.
TEST(Prescription, EveryKeyOfTomlIsRead) {
  using Kind = PrescribedAperture::Kind;
  Prescription const all = read_prescription(file_of("all_keys.toml", R"(schema = 1
title = "all keys"
source = "a test"
primary_wavelength_nm = 532.0
object_distance_mm = 400.0
object_na = 0.01
field_deg = [0.0, 3.0]
[[surface]]
curvature_per_mm = 0.02
conic = -0.5
asphere_mm = [0.0, 1e-6]
thickness_mm = 6.0
index = 1.5
semi_diameter_mm = 8.0
obscured_mm = 1.0
stop = true
[[surface]]
shape = "cylinder"
radius_mm = -50.0
decentre_mm = [1.0, -2.0]
tilt_deg = [3.0, 4.0, 5.0]
nd = 1.62
vd = 60.3
thickness_mm = 2.0
[[surface]]
glass = "mirror"
thickness_mm = -3.0
[[surface]]
)"));
  EXPECT_EQ(all.title, "all keys");
  EXPECT_EQ(all.source, "a test");
  EXPECT_NEAR(all.primary_wavelength, 532e-9, 1e-20);
  EXPECT_NEAR(all.object_distance, 0.4, 1e-15);
  EXPECT_EQ(all.aperture.kind, Kind::object_na);
  EXPECT_EQ(all.aperture.value, 0.01);
  ASSERT_EQ(all.field_angles.size(), 2u);
  EXPECT_NEAR(all.field_angles[1], 3 * unit::degree, 1e-15);
  ASSERT_EQ(all.surfaces.size(), 4u);
  PrescribedSurface const &first = all.surfaces[0], &second = all.surfaces[1], &third = all.surfaces[2];
  EXPECT_NEAR(first.curvature, 20, 1e-12);
  EXPECT_EQ(first.conic, -0.5);
  ASSERT_EQ(first.asphere.size(), 2u);
  EXPECT_EQ(first.asphere[0], 0);
  EXPECT_NEAR(first.asphere[1], 1e3, 1e-10);
  EXPECT_NEAR(first.thickness, 6e-3, 1e-17);
  EXPECT_EQ(std::get<PrescribedMedium::Index>(first.after.is).n, 1.5);
  EXPECT_NEAR(first.semi_diameter, 8e-3, 1e-17);
  EXPECT_NEAR(first.obscured, 1e-3, 1e-17);
  EXPECT_TRUE(first.stop && !second.stop);
  EXPECT_EQ(second.shape, PrescribedSurface::Shape::cylinder);
  EXPECT_NEAR(second.curvature, -20, 1e-12);
  ASSERT_EQ(second.before.size(), 1u);
  EXPECT_LT(length(second.before[0].decentre - Vec2d{1e-3, -2e-3}), 1e-17);
  EXPECT_LT(length(second.before[0].tilt - unit::degree * Vec3d{3, 4, 5}), 1e-15);
  EXPECT_EQ(std::get<PrescribedMedium::Described>(second.after.is).nd, 1.62);
  EXPECT_EQ(std::get<PrescribedMedium::Described>(second.after.is).vd, 60.3);
  EXPECT_EQ(third.curvature, 0) << "a plane, unless a radius is given";
  EXPECT_TRUE(third.after.is_mirror());
  EXPECT_NEAR(third.thickness, -3e-3, 1e-17);
  EXPECT_TRUE(all.surfaces[3].after.is_air());
  EXPECT_TRUE(std::isinf(all.surfaces[3].semi_diameter));

  Prescription const few = read_prescription(file_of("few_keys.toml", toml));
  EXPECT_TRUE(std::isinf(few.object_distance));
  EXPECT_EQ(few.primary_wavelength, 0) << "the d line, unless a setup has another";
  EXPECT_EQ(few.aperture.kind, Kind::f_number);
  EXPECT_EQ(std::get<PrescribedMedium::Named>(few.surfaces[0].after.is).glass, "N-BK7");
  Prescription const pupil =
      read_prescription(file_of("pupil.toml", changed(toml, "f_number = 8.0", "entrance_pupil_mm = 6.0")));
  EXPECT_EQ(pupil.aperture.kind, Kind::entrance_pupil);
  EXPECT_NEAR(pupil.aperture.value, 6e-3, 1e-17);
  std::string const own =
      changed(changed(toml, "f_number = 8.0\n", ""), "stop = true", "stop = true\nsemi_diameter_mm = 3");
  EXPECT_NEAR(paraxial_of("own.toml", own).entrance.diameter, 6e-3, 1e-15) << "the stop's own semi-diameter";
  EXPECT_EQ(refusal("two.toml", changed(toml, "f_number", "entrance_pupil_mm = 6.0\nf_number")),
            "invalid_value at two.toml:4:1");
  EXPECT_EQ(refusal("glasses.toml", changed(toml, "glass = \"N-BK7\"", "glass = \"N-BK7\"\nindex = 1.5")),
            "invalid_value at glasses.toml:7:1");
  EXPECT_EQ(refusal("radii.toml", changed(toml, "radius_mm = 50.0", "radius_mm = 50.0\ncurvature_per_mm = 0.02")),
            "invalid_value at radii.toml:5:1");
}

// Design programs write UTF-16, UTF-8 with a byte order mark or ISO-8859-1, with any line ends: the lens is the same.
TEST(Prescription, EncodingDoesNotMatter) {
  double const f = paraxial_of("utf8.zmx", zmx).effective_focal_length;
  std::string windows;
  for (char const c : std::string(zmx)) windows += c == '\n' ? std::string("\r\n") : std::string{c};
  EXPECT_EQ(paraxial_of("le.zmx", utf16(zmx, true)).effective_focal_length, f);
  EXPECT_EQ(paraxial_of("be.zmx", utf16(windows, false)).effective_focal_length, f);
  EXPECT_EQ(paraxial_of("bom.zmx", "\xef\xbb\xbf" + windows).effective_focal_length, f);
  EXPECT_EQ(paraxial_of("latin.zmx", "NOTE 0 f\xfcr\n" + std::string(zmx)).effective_focal_length, f);
}

// A coordinate break followed by the opposite one in reversed order restores the frame.
TEST(Prescription, CoordinateBreaksUndoThemselves) {
  std::string const there =
      "SURF 1\n  TYPE COORDBRK\n  PARM 1 1.5\n  PARM 2 -0.7\n  PARM 3 12\n  PARM 4 -7\n  PARM 5 30\n"
      "  PARM 6 0\n  DISZ 0\n";
  std::string const back =
      "SURF 2\n  TYPE COORDBRK\n  PARM 1 -1.5\n  PARM 2 0.7\n  PARM 3 -12\n  PARM 4 7\n  PARM 5 -30\n"
      "  PARM 6 1\n  DISZ 0\n";
  std::string text = zmx;
  for (auto const& [from, to] : {std::pair{"SURF 3", "SURF 5"}, {"SURF 2", "SURF 4"}, {"SURF 1\n", "SURF 3\n"}}) {
    text.replace(text.find(from), std::string(from).size(), to);
  }
  text.insert(text.find("SURF 3\n"), there + back);
  Lens const lens =
      build_lens(read_prescription(file_of("broken.zmx", text)), GlassCatalogue::shipped(), spectral_line::d);
  EXPECT_LT(length(lens.poses[0].origin), 1e-15);
  EXPECT_LT(length(lens.poses[0].x - Vec3d{1, 0, 0}), 1e-15);
  EXPECT_LT(length(lens.poses[0].z - Vec3d{0, 0, 1}), 1e-15);
}

// A truncated file must not be read as another, shorter lens: if it ends before its image surface is complete, it is
// refused, or a warning is given if it ends within a line DISZ that may belong to the image. Breaks and glass surfaces
// may have a thickness of 0, as the image does, and a number may be truncated to 0.
TEST(Prescription, RefusesZemaxFilesThatAreCutShort) {
  std::string const more =
      "SURF 3\n  TYPE COORDBRK\n  DISZ 0\nSURF 4\n  DISZ 0.5\n  GLAS N-BK7 0 0\nSURF 5\n  DISZ 0.7\nSURF 6\n";
  std::string const text = changed(zmx, "SURF 3\n", more);
  ASSERT_EQ(refusal("whole.zmx", text), "");
  for (std::size_t cut = 0; cut < text.size(); ++cut) {
    std::string const kept = text.substr(0, cut);
    if (!refusal("cut.zmx", kept).empty()) continue;
    EXPECT_THAT(read_prescription(file_of("cut.zmx", kept)).warnings,
                Contains(testing::Field(&Warning::code, WarningCode::incomplete)))
        << kept;
  }
  EXPECT_EQ(refusal("cut.zmx", text.substr(0, text.find("SURF 4"))), "damaged at cut.zmx:27");
}

// All unknown glasses are reported together, each with its line and the most similar names; a single one is reported in
// the same way.
TEST(Prescription, NamesAllUnknownGlassesTogether) {
  std::string const three =
      changed(changed(toml, "N-BK7", "N-BK77"), "thickness_mm = 0.0", "thickness_mm = 2.0\nglass = \"SF99\"") +
      "[[surface]]\nradius_mm = inf\nthickness_mm = 1.0\nglass = \"F5\"\n[[surface]]\nradius_mm = inf\n";
  EXPECT_EQ(refusal("glasses.toml", three), "unknown_choice at glasses.toml:7:1, unknown_choice at glasses.toml:12:1");
  EXPECT_EQ(refusal("glasses.toml", changed(three, "SF99", "SF6")), "unknown_choice at glasses.toml:7:1");
}

// "STO S2" marks the second surface, wherever the command is; the number of a surface that does not exist is refused.
TEST(Prescription, CodeVCommandsNameTheirSurface) {
  auto const stop_of = [](std::string const& text) {
    Prescription const lens = read_prescription(file_of("named.seq", text));
    return lens.surfaces[0].stop ? 1 : lens.surfaces[1].stop ? 2 : 0;
  };
  std::string const unmarked = changed(seq, "  STO; CIR 8.0\n", "");
  EXPECT_EQ(stop_of(changed(unmarked, "SI 0.0", "STO S1\nSI 0.0")), 1);
  EXPECT_EQ(stop_of(changed(unmarked, "GO\n", "STO s2\nGO\n")), 2);
  EXPECT_EQ(stop_of(seq), 1);
  Prescription const conic = read_prescription(file_of("named.seq", changed(seq, "SI 0.0", "K S1 -0.5\nSI 0.0")));
  EXPECT_EQ(conic.surfaces[0].conic, -0.5);
  EXPECT_EQ(conic.surfaces[1].conic, 0);
  EXPECT_EQ(refusal("t.seq", changed(unmarked, "GO\n", "STO S3\nGO\n")), "invalid_value at t.seq:12");
  EXPECT_EQ(refusal("u.seq", changed(unmarked, "GO\n", "STO L'iris'\nGO\n")), "syntax at u.seq:12");
  EXPECT_EQ(refusal("v.seq", changed(unmarked, "GO\n", "STO\nGO\n")), "invalid_value at v.seq:12");
}

// Fields that are not angles in the y-z plane are not ignored silently; fields on the axis need no warning.
TEST(Prescription, TellsOfFieldsThatAreLeftOut) {
  auto const notes = [](char const* name, std::string const& text) {
    return read_prescription(file_of(name, text)).warnings;
  };
  EXPECT_THAT(notes("heights.zmx", changed(zmx, "FTYP 0", "FTYP 1")), ElementsAre(Warns("ignored at heights.zmx:6")));
  EXPECT_THAT(notes("axis.zmx", changed(changed(zmx, "FTYP 0", "FTYP 1"), "YFLN 0 5.0", "YFLN 0 0")), IsEmpty());
  EXPECT_THAT(notes("across.zmx", changed(zmx, "YFLN", "XFLN 0 3.0\nYFLN")),
              ElementsAre(Warns("ignored at across.zmx:7")));
  EXPECT_THAT(notes("along.zmx", changed(zmx, "YFLN", "XFLN 0 0.0\nYFLN")), IsEmpty());
  EXPECT_THAT(notes("across.seq", changed(seq, "REF 2", "REF 2\nXAN 0 3")),
              ElementsAre(Warns("ignored at across.seq:7")));
  EXPECT_THAT(notes("heights.seq", changed(seq, "REF 2", "REF 2\nYOB 0 3")),
              ElementsAre(Warns("ignored at heights.seq:7")));
  EXPECT_THAT(notes("along.seq", changed(seq, "REF 2", "REF 2\nXAN 0 0\nYAN 0 5")), IsEmpty());
}

// A wavelength in the wrong unit would be far outside the range of every glass. Wavelengths other than the primary one
// may have any value, since design programs write unused ones.
TEST(Prescription, WavelengthsInTheWrongUnitAreRefused) {
  EXPECT_EQ(refusal("nm.zmx", changed(zmx, "WAVM 2 0.58756180", "WAVM 2 550")), "out_of_range at nm.zmx:9");
  EXPECT_EQ(refusal("unused.zmx", changed(zmx, "WAVM 1 0.48613270", "WAVM 1 550")), "");
  EXPECT_EQ(refusal("um.seq", changed(seq, "WL 486.1 587.5618", "WL 0.4861 0.532")), "out_of_range at um.seq:5");
  EXPECT_EQ(refusal("metres.seq", changed(seq, "WL 486.1 587.5618", "WL 486.1e-9 532e-9")),
            "out_of_range at metres.seq:5");
  EXPECT_EQ(refusal("minus.seq", changed(seq, "WL 486.1 587.5618", "WL 486.1 -532")), "out_of_range at minus.seq:5");
  EXPECT_EQ(refusal("um.toml", changed(toml, "f_number", "primary_wavelength_nm = 0.5876\nf_number")),
            "out_of_range at um.toml:3:1");
  EXPECT_EQ(refusal("private.seq", changed(seq, "SO 0.0", "PRV\nPWL 0.6563 0.4861\n'own' 1.5 1.51\nEND\nSO 0.0")),
            "out_of_range at private.seq:8");
  EXPECT_EQ(refusal("infrared.seq", changed(changed(seq, "WL 486.1 587.5618", "WL 10600"), "REF 2", "REF 1")), "");
}

// Each assumption about missing data is reported by one warning with a line.
TEST(Prescription, AMissingWavelengthOrApertureIsWarnedOfAtALine) {
  auto const notes = [](char const* name, std::string const& text) {
    return read_prescription(file_of(name, text)).warnings;
  };
  EXPECT_THAT(notes("none.seq", changed(changed(seq, "WL 486.1 587.5618\n", ""), "REF 2\n", "")),
              ElementsAre(Warns("assumed at none.seq:5", HasSubstr("587.5618 nm"))));
  EXPECT_THAT(notes("zero.zmx", changed(zmx, "WAVM 2 0.58756180", "WAVM 2 0")),
              ElementsAre(Warns("assumed at zero.zmx:9")));
  EXPECT_THAT(notes("other.zmx", changed(zmx, "PWAV 2", "PWAV 3")), ElementsAre(Warns("assumed at other.zmx:11")));
  EXPECT_THAT(notes("open.zmx", changed(zmx, "ENPD 6.0\n", "")), ElementsAre(Warns("assumed at open.zmx:14")));
  EXPECT_THAT(notes("open.seq", changed(seq, "EPD 6.0\n", "")), ElementsAre(Warns("assumed at open.seq:7")));
  EXPECT_NEAR(paraxial_of("open.seq", changed(seq, "EPD 6.0\n", "")).entrance.diameter, 16e-3, 1e-15);
  // a numerical aperture defines no cone for an object at infinity
  EXPECT_THAT(notes("cone.zmx", changed(zmx, "ENPD 6.0", "OBNA 0.1 0")), ElementsAre(Warns("assumed at cone.zmx:5")));
  EXPECT_THAT(notes("near.zmx", changed(changed(zmx, "ENPD 6.0", "OBNA 0.01 0"), "DISZ INFINITY", "DISZ 150")),
              IsEmpty());
}

// Typical mistakes of users: each error message contains file, line and cause.
TEST(Prescription, RefusesBadFilesByLineAndCause) {
  EXPECT_EQ(refusal("a.zmx", changed(zmx, "  TYPE STANDARD\n  CURV -0.02", "  TYPE BINARY_2\n  CURV -0.02")),
            "unsupported at a.zmx:23");
  EXPECT_EQ(refusal("b.zmx", changed(zmx, "N-BK7", "N-BK8")), "unknown_choice at b.zmx:20");
  EXPECT_EQ(refusal("c.zmx", changed(zmx, "CURV 0.02", "CURV nan")), "syntax at c.zmx:18");
  EXPECT_EQ(refusal("d.zmx", std::string(zmx).substr(0, 240)), "missing_content at d.zmx");
  EXPECT_EQ(refusal("e.zmx", changed(zmx, "MODE SEQ", "MODE NSC")), "unsupported at e.zmx:2");
  EXPECT_EQ(refusal("f.zmx", utf16(zmx, true).substr(0, 501)), "damaged at f.zmx");
  EXPECT_EQ(refusal("g.toml", changed(toml, "stop = true\n", "")), "missing_content at g.toml");
  EXPECT_EQ(refusal("j.zmx", std::string(200, '\0')), "wrong_format at j.zmx");
  EXPECT_EQ(refusal("l.seq", changed(seq, "STO;", "STO; GRO 3;")), "unsupported at l.seq:9");
  EXPECT_EQ(refusal("n.toml", changed(toml, "radius_mm = 50.0", "radius_mm = 0.0")), "invalid_value at n.toml:5:1");
  EXPECT_EQ(refusal("o.toml", changed(toml, "glass", "glas")), "unknown_key at o.toml:7:1");
  EXPECT_EQ(refusal("p.toml", changed(toml, "thickness_mm = 6.0", "thickness_mm = nan")), "out_of_range at p.toml:6:1");
  EXPECT_EQ(refusal("q.lens", toml), "unsupported at q.lens");
  EXPECT_EQ(refusal("r.toml", "schema = 1\n"), "missing_content at r.toml");
  EXPECT_EQ(refusal("s.toml", changed(toml, "f_number = 8.0", "")), "missing_content at s.toml:4:1");
}

}  // namespace
}  // namespace gladstone
