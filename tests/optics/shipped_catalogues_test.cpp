#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "render/base/error.h"
#include "render/optics/glass.h"
#include "render/optics/glass_catalogue.h"
#include "render/optics/lens.h"
#include "render/optics/prescription.h"
#include "tests/optics/prescription_texts.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

GlassMatch shipped_match(std::string const& name, std::vector<std::string> const& preferred = {}) {
  return GlassCatalogue::shipped().match(name, spectral_line::d, "lens:1", preferred);
}

// The manufacturers' tables of indices at the lines C, d and F, from 2018 (HOYA) to 2024 (CDGM), printed to five or six
// digits.
TEST(ShippedCatalogues, GlassesHaveTheIndicesOfTheirDataSheets) {
  struct Row {
    char const* glass;
    double n_C, n_d, n_F;
    double rounding;
  };
  Row const rows[] = {
      {"OHARA:S-BSL7", 1.51386, 1.51633, 1.52191, 6e-6},    {"OHARA:S-FPL53", 1.43733, 1.43875, 1.44195, 6e-6},
      {"OHARA:S-TIH53", 1.83649, 1.84666, 1.87210, 6e-6},   {"OHARA:S-LAH79", 1.99301, 2.00330, 2.02850, 6e-6},
      {"HOYA:FCD1", 1.49514, 1.49700, 1.50123, 6e-6},       {"HOYA:BSC7", 1.51432, 1.51680, 1.52237, 6e-6},
      {"HOYA:TAFD30", 1.87657, 1.88300, 1.89821, 6e-6},     {"HOYA:E-FDS1", 1.91038, 1.92286, 1.95457, 6e-6},
      {"HIKARI:J-FK01A", 1.495139, 1.497, 1.501226, 6e-7},  {"HIKARI:J-BK7A", 1.514324, 1.5168, 1.522382, 6e-7},
      {"HIKARI:J-SF6", 1.796109, 1.80518, 1.827749, 6e-7},  {"HIKARI:J-LASFH17", 1.989413, 2.00069, 2.028724, 6e-7},
      {"CDGM:H-FK61", 1.49514, 1.497, 1.50123, 1e-6},       {"CDGM:H-K9L", 1.514326, 1.5168, 1.522376, 1e-6},
      {"CDGM:H-ZF52", 1.836496, 1.84666, 1.872093, 1e-6},   {"SUMITA:K-BK7", 1.51385, 1.51633, 1.52191, 1e-5},
      {"SUMITA:K-CaFK95", 1.43285, 1.43425, 1.43742, 1e-5}, {"SUMITA:K-LaFn5", 1.73845, 1.74300, 1.75354, 1e-5},
  };
  for (Row const& row : rows) {
    Glass const& glass = *shipped_match(row.glass).glass;
    EXPECT_NEAR(glass.index(spectral_line::C), row.n_C, row.rounding) << row.glass;
    EXPECT_NEAR(glass.nd(), row.n_d, row.rounding) << row.glass;
    EXPECT_NEAR(glass.index(spectral_line::F), row.n_F, row.rounding) << row.glass;
  }
}

// OHARA's table of the internal transmittance of 10 mm of S-BSL7.
TEST(ShippedCatalogues, GlassesTransmitWhatTheirDataSheetsSay) {
  Glass const& glass = *shipped_match("S-BSL7").glass;
  auto const transmittance = [&](double wavelength) { return std::exp(-glass.absorption(wavelength) * 10e-3); };
  EXPECT_NEAR(transmittance(300e-9), 0.31, 2e-6);
  EXPECT_NEAR(transmittance(350e-9), 0.968, 2e-6);
  EXPECT_NEAR(transmittance(400e-9), 0.997, 2e-6);
  EXPECT_NEAR(transmittance(1400e-9), 0.982, 2e-6);
  EXPECT_NEAR(transmittance(2400e-9), 0.85, 2e-6);
}

// Manufacturers state nd in addition to the coefficients, rounded to five or six digits, SUMITA less exactly: a wrong
// copy of either would be detected.
TEST(ShippedCatalogues, FormulasGiveTheStatedIndex) {
  int stated = 0;
  for (Glass const* glass : GlassCatalogue::shipped().glasses()) {
    if (glass->printed_nd == 0 || glass->catalogue == "MISC") continue;  // MISC has three digits only
    EXPECT_NEAR(glass->nd(), glass->printed_nd, glass->catalogue == "SUMITA" ? 4e-5 : 6e-6) << glass->name;
    ++stated;
  }
  EXPECT_GT(stated, 1600);
}

TEST(ShippedCatalogues, GlassesNameTheirLine) {
  Glass const& glass = *shipped_match("J-LASFH17").glass;
  EXPECT_EQ(glass.name, "J-LASFH17");
  EXPECT_EQ(glass.catalogue, "HIKARI");
  GlassCatalogue from_file;
  from_file.add_file(std::string(GLADSTONE_DATA_DIR) + "/glasses/hikari.agf");
  Glass const& same = *from_file.match("J-LASFH17", spectral_line::d, "lens:1").glass;
  EXPECT_EQ("data/" + same.where.substr(std::string(GLADSTONE_DATA_DIR).size() + 1), glass.where);
  EXPECT_EQ(glass.coefficients, same.coefficients);
  EXPECT_EQ(glass.transmission.size(), same.transmission.size());
}

// The index of F2 is 1.62004 for SCHOTT and HIKARI, but 1.61293 for CDGM; BAF10 is the same glass of HOYA and HIKARI.
TEST(ShippedCatalogues, AreSearchedInTheDocumentedOrder) {
  GlassMatch const f2 = shipped_match("F2");
  EXPECT_EQ(f2.glass->catalogue, "SCHOTT");
  EXPECT_THAT(f2.notes,
              ElementsAre(testing::Field(&Warning::text, AllOf(HasSubstr("SCHOTT:F2 (data/glasses/schott.agf:"),
                                                               HasSubstr("HIKARI:F2"), HasSubstr("CDGM:F2")))));
  GlassMatch const baf10 = shipped_match("BAF10");
  EXPECT_EQ(baf10.glass->catalogue, "HOYA");
  EXPECT_THAT(baf10.notes, IsEmpty());
  EXPECT_NEAR(shipped_match("CDGM:F2").glass->nd(), 1.61293, 1e-5);
  EXPECT_THAT(shipped_match("CDGM:F2").notes, IsEmpty());
  EXPECT_EQ(shipped_match("F2_HIKARI").glass->catalogue, "HIKARI");
}

TEST(ShippedCatalogues, TheLensFileChoosesAmongThem) {
  struct Row {
    char const *listed, *catalogue;
  };
  for (Row const& row : {Row{"CDGM", "CDGM"}, Row{"hikari", "HIKARI"}, Row{"NIKON", "HIKARI"}}) {
    GlassMatch const f2 = shipped_match("F2", {"CORNING", row.listed});
    EXPECT_EQ(f2.glass->catalogue, row.catalogue);
    EXPECT_THAT(f2.notes, IsEmpty()) << row.listed;
  }
}

// CDGM's F4, nd 1.62005, differs from SCHOTT's former F4, nd 1.61659: a lens file that lists SCHOTT does not get it
// without a note.
TEST(ShippedCatalogues, AGlassOfACatalogueThatTheLensFileDoesNotListIsNoted) {
  GlassMatch const f4 = shipped_match("F4", {"SCHOTT"});
  EXPECT_EQ(f4.glass->catalogue, "CDGM");
  EXPECT_THAT(f4.notes,
              ElementsAre(testing::Field(&Warning::text, AllOf(HasSubstr("(SCHOTT)"), HasSubstr("CDGM:F4")))));
  EXPECT_THAT(shipped_match("F4").notes, IsEmpty());
}

// HIKARI and CDGM have different glasses BAF4; for a lens file that lists SCHOTT, it is N-BAF4, the successor of
// SCHOTT's BAF4.
TEST(ShippedCatalogues, TheSuccessorInTheListedCatalogueComesBeforeOtherMakersGlasses) {
  GlassMatch const schott = shipped_match("BAF4", {"SCHOTT"});
  EXPECT_EQ(schott.glass->name, "N-BAF4");
  EXPECT_THAT(schott.notes, ElementsAre(testing::Field(&Warning::text, HasSubstr("SCHOTT:N-BAF4"))));
  EXPECT_EQ(shipped_match("BAF4", {"CDGM"}).glass->catalogue, "CDGM");
  EXPECT_EQ(shipped_match("SCHOTT:BAF4").glass->name, "N-BAF4");
  GlassMatch const open = shipped_match("BAF4");
  EXPECT_EQ(open.glass->catalogue, "HIKARI");
  EXPECT_THAT(open.notes,
              ElementsAre(testing::Field(&Warning::text, AllOf(HasSubstr("HIKARI:BAF4"), HasSubstr("CDGM:BAF4")))));
}

// A catalogue added by the user is an explicit choice, whatever its name, also if it is a newer edition of a shipped
// one.
TEST(ShippedCatalogues, CataloguesOfTheUserComeFirst) {
  GlassCatalogue glasses = GlassCatalogue::shipped();
  glasses.add("NM S-BSL7 1\nCD 2.25\nLD 0.4 0.7\nNM N-BK7 1\nCD 2.25\nLD 0.4 0.7\n", "OWN", "own.agf");
  glasses.add("NM N-BK7 1\nCD 2.56\nLD 0.4 0.7\n", "SCHOTT_2020", "schott_2020.agf");
  EXPECT_NEAR(glasses.match("S-BSL7", 5e-7, "lens:1").glass->index(5e-7), 1.5, 1e-15);
  EXPECT_NEAR(glasses.match("N-BK7", 5e-7, "lens:1").glass->index(5e-7), 1.6, 1e-15);
  EXPECT_THAT(
      glasses.match("S-BSL7", 5e-7, "lens:1").notes,
      ElementsAre(Warns("assumed at lens:1", AllOf(HasSubstr("OWN:S-BSL7 (own.agf:1)"), HasSubstr("OHARA:S-BSL7")))));
  GlassMatch const newer = glasses.match("N-BK7", 5e-7, "lens:1", {"SCHOTT"});
  EXPECT_EQ(newer.glass->catalogue, "SCHOTT_2020");
  EXPECT_FALSE(newer.assumed);
}

/// Returns a singlet at the d line whose glass is given by a line GLAS, in a file that lists catalogues.
Lens lens_of_glass(std::string const& glass, std::string const& listed = "") {
  std::string const text = changed(zmx, "GLAS N-BK7 0 0 1.5 40", "GLAS " + glass);
  return build_lens(read_prescription(file_of(
                        "flint.zmx", listed.empty() ? text : changed(text, "PWAV 2", "PWAV 2\nGCAT " + listed))),
                    GlassCatalogue::shipped(), spectral_line::d);
}

/// Returns the index behind the first surface.
double index_of(Lens const& lens) { return lens.paraxial.front().n_after; }

// The line of SCHOTT's former F4 states nd 1.61659, which differs from the only F4 of the catalogues; CDGM's is
// 1.62005.
TEST(ShippedCatalogues, AGlassThatContradictsTheLensFileIsNotTaken) {
  EXPECT_THAT(lens_of_glass("F4 0 0 1.61659 36.63").warnings,
              ElementsAre(Warns("inconsistent at flint.zmx:20",
                                AllOf(HasSubstr("CDGM:F4"), HasSubstr("1.62005"), HasSubstr("1.61659")))));
  EXPECT_THAT(lens_of_glass("F4 0 0 1.62005 36.35").warnings, IsEmpty());
}

// F2 is 1.62004 in SCHOTT's catalogue and 1.61293 in CDGM's.
TEST(ShippedCatalogues, TheIndexOfTheLineDecidesWhereTheFileListsNoCatalogue) {
  Lens const schott = lens_of_glass("F2 0 0 1.62 36.37");
  EXPECT_NEAR(index_of(schott), 1.62004, 1e-5);
  EXPECT_THAT(schott.warnings, IsEmpty());
  Lens const cdgm = lens_of_glass("F2 0 0 1.61293 36.96");
  EXPECT_EQ(index_of(cdgm), shipped_match("CDGM:F2").glass->nd());
  EXPECT_THAT(cdgm.warnings,
              ElementsAre(Warns("assumed at flint.zmx:20",
                                AllOf(HasSubstr("SCHOTT:F2"), HasSubstr("CDGM:F2"), HasSubstr("1.61293")))));
}

TEST(ShippedCatalogues, AListedGlassThatContradictsItsLineIsTakenWithAWarning) {
  Lens const lens = lens_of_glass("F2 0 0 1.61293 36.96", "SCHOTT CDGM");
  EXPECT_NEAR(index_of(lens), 1.62004, 1e-5);
  EXPECT_THAT(lens.warnings,
              ElementsAre(Warns("inconsistent at flint.zmx:21",
                                AllOf(HasSubstr("SCHOTT:F2"), HasSubstr("1.62004"), HasSubstr("1.61293")))));
  EXPECT_THAT(lens_of_glass("F2 0 0 1.61293 36.96", "CDGM").warnings, IsEmpty());
}

// SCHOTT's LAK8 and N-LAK8 both have nd = 1.713; a line with another nd means another glass.
TEST(ShippedCatalogues, TheSuccessorIsTakenUnlessTheLineContradictsIt) {
  Lens const lens = lens_of_glass("LAK8 0 0 1.713 53.83");
  EXPECT_EQ(index_of(lens), shipped_match("N-LAK8").glass->nd());
  EXPECT_THAT(lens.warnings, ElementsAre(Warns("assumed at flint.zmx:20", HasSubstr("SCHOTT:N-LAK8"))));
  Lens const other = lens_of_glass("LAK8 0 0 1.65 50");
  EXPECT_NEAR(index_of(other), 1.65, 1e-12);
  EXPECT_THAT(other.warnings,
              ElementsAre(Warns("inconsistent at flint.zmx:20",
                                AllOf(HasSubstr("SCHOTT:N-LAK8"), HasSubstr("1.713"), HasSubstr("1.65")))));
}

// Neither the catalogue listed in the lens file nor any other one contains BK7: one note reports this.
TEST(ShippedCatalogues, ASuccessorInACatalogueThatTheLensFileDoesNotListIsNotedOnce) {
  EXPECT_THAT(shipped_match("BK7", {"HOYA"}).notes,
              ElementsAre(testing::Field(&Warning::text, AllOf(HasSubstr("SCHOTT:N-BK7"), HasSubstr("HOYA")))));
}

// Glasses are read when they are first used, by any thread, and only once: all threads get the same glass.
TEST(ShippedCatalogues, AreReadByAllThreadsAtOnce) {
  std::vector<std::vector<Glass const*>> seen(4);
  {
    std::vector<std::thread> threads;
    for (auto& glasses : seen) threads.emplace_back([&glasses] { glasses = GlassCatalogue::shipped().glasses(); });
    for (std::thread& thread : threads) thread.join();
  }
  for (auto const& glasses : seen) EXPECT_EQ(glasses, seen.front());
}

}  // namespace
}  // namespace gladstone
