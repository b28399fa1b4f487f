#include "render/optics/glass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "render/optics/glass_catalogue.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Glass const& glass(std::string const& name) { return *GlassCatalogue::shipped().match(name, 550e-9, "test:1").glass; }

/// Abbe number (nd - 1) / (nF - nC).
double abbe_number(Glass const& glass) {
  return (glass.nd() - 1) / (glass.index(spectral_line::F) - glass.index(spectral_line::C));
}

// Schott's data sheet of N-BK7: nF, nd, nC, Vd; the values at 532 and 632.8 nm are computed by the same formula to nine
// digits.
TEST(Glass, BK7HasItsDataSheetsIndices) {
  Glass const& bk7 = glass("N-BK7");
  EXPECT_NEAR(bk7.index(486.1327e-9), 1.52237629, 5e-9);
  EXPECT_NEAR(bk7.index(532e-9), 1.519472583, 5e-10);
  EXPECT_NEAR(bk7.nd(), 1.516800035, 5e-10);
  EXPECT_NEAR(bk7.index(632.8e-9), 1.515089198, 5e-10);
  EXPECT_NEAR(bk7.index(656.2725e-9), 1.514322347, 5e-10);
  EXPECT_NEAR(abbe_number(bk7), 64.167336, 5e-6);
}

// I. H. Malitson, J. Opt. Soc. Am. 55 (1965) 1205.
TEST(Glass, FusedSilicaHasMalitsonsIndices) {
  EXPECT_NEAR(glass("SILICA").index(532e-9), 1.460706345, 5e-10);
  EXPECT_NEAR(glass("silica").nd(), 1.458463687, 5e-10);
}

// Zemax's name of fused silica contains an underscore that does not separate a catalogue; in CODE V's names it does.
TEST(Glass, ABarMayBePartOfTheName) {
  GlassCatalogue catalogue;
  std::string const malitson =
      " 2\nCD 0.6961663 0.00467914826 0.4079426 0.0135120631 0.8974794 97.9340025\nLD 0.21 3.7\n";
  catalogue.add("NM F_SILICA" + malitson + "NM OTHER" + malitson, "OWN", "own.agf");
  EXPECT_EQ(catalogue.match("F_SILICA", 532e-9, "test:1").glass->name, "F_SILICA");
  EXPECT_EQ(catalogue.match("f_silica_own", 532e-9, "test:1").glass->name, "F_SILICA");
  EXPECT_EQ(catalogue.match("OWN:F_SILICA", 532e-9, "test:1").glass->name, "F_SILICA");
  EXPECT_EQ(catalogue.match("OTHER_OWN", 532e-9, "test:1").glass->name, "OTHER");
  EXPECT_EQ(error_of([&] { catalogue.match("OTHER_SCHOTT", 532e-9, "test:1"); }), "unknown_choice at test:1");
}

// 1628 glasses: 156 of SCHOTT, 410 OHARA, 190 HOYA, 375 HIKARI, 314 CDGM, 176 SUMITA and 7 others. The extremes in
// their manufacturers' catalogues are magnesium fluoride (nd 1.3777, Vd 106.2), SUMITA's K-PSFn215 (nd 2.1540) and
// HOYA's FDS16-W (Vd 16.48). With a wrong coefficient, a glass would most likely be outside of these limits.
TEST(Glass, EveryShippedGlassHasAPlausibleIndexAndAbbeNumber) {
  EXPECT_GT(GlassCatalogue::shipped().glasses().size(), 1627u);
  for (Glass const* g : GlassCatalogue::shipped().glasses()) {
    if (g->shortest > 486.1e-9 || g->longest < 656.3e-9) continue;
    EXPECT_GT(g->nd(), 1.377) << g->name;
    EXPECT_LT(g->nd(), 2.155) << g->name;
    EXPECT_GT(abbe_number(*g), 16.4) << g->name;
    EXPECT_LT(abbe_number(*g), 106.3) << g->name;
  }
}

// n = A + B / lambda^2 has the nd and Vd from which it was made, and is within 1e-3 of the real glass in the visible.
TEST(Glass, DescribedByNdAndVdReturnsThem) {
  Glass const described = Glass::from_nd_vd(1.5168, 64.17);
  EXPECT_NEAR(described.nd(), 1.5168, 1e-14);
  EXPECT_NEAR(abbe_number(described), 64.17, 1e-9);
  for (double const wavelength : {450e-9, 532e-9, 650e-9}) {
    EXPECT_NEAR(described.index(wavelength), glass("N-BK7").index(wavelength), 1e-3);
  }
}

// 10 mm of F2 transmit the light stated in the catalogue, also between its wavelengths: Beer's law, with linear
// interpolation of the absorption coefficient.
TEST(Glass, AbsorbsAsTheCatalogueSays) {
  Glass const& bk7 = glass("N-BK7");
  ASSERT_FALSE(bk7.transmission.empty());
  for (auto const& t : bk7.transmission) {
    EXPECT_NEAR(std::exp(-bk7.absorption(t.wavelength) * t.thickness), t.transmission, 1e-12);
  }
  EXPECT_GT(std::exp(-bk7.absorption(532e-9) * 10e-3), 0.995);
}

TEST(GlassCatalogue, FindsNamesAsProgramsWriteThem) {
  for (char const* name : {"N-BK7", "n-bk7", "NBK7", "NBK7_SCHOTT", "SCHOTT:N-BK7"}) {
    EXPECT_EQ(glass(name).name, "N-BK7") << name;
  }
}

TEST(GlassCatalogue, NamesTheNearestGlassAndTheRange) {
  auto const suggests = [](auto const&... names) {
    return ThrowsDataError(ErrorCode::unknown_choice, "test:1", AllOf(HasSubstr(names)...));
  };
  EXPECT_THAT([] { glass("N-BK77"); }, suggests("\"SCHOTT:N-BK7\""));
  // several names are equally similar; the successor of a glass with lead is named first
  EXPECT_THAT([] { glass("N-BK8"); }, suggests("\"SCHOTT:N-BK7\"", " or \"SCHOTT:"));
  EXPECT_THAT([] { glass("BAF10X"); }, suggests("\"SCHOTT:N-BAF10\""));
  EXPECT_EQ(error_of([] { GlassCatalogue::shipped().match("N-BK7", 12e-6, "test:1"); }), "out_of_range at test:1");
}

// Compares each dispersion formula with its definition at one micrometre, where every power of the wavelength is one.
TEST(GlassCatalogue, KnowsAllFormulasOfTheFormat) {
  struct Row {
    int formula;
    char const* coefficients;
    double index;
  };
  Row const rows[] = {
      {1, "2 .1 .05 .02 .01 .005", std::sqrt(2.185)},
      {2, "1 .01 .2 .02 .5 100", std::sqrt(1 + 1 / .99 + .2 / .98 - .5 / 99)},
      {3, "1.5 .01 .001 .002 .003 .004", 1.5 + .01 / .972 + .001 / (.972 * .972) + .009},
      {4, "1 .2 .1 .3 .2", std::sqrt(2 + .2 / .99 + .3 / .96)},
      {5, "1.5 .01 .002", 1.512},
      {6, "1 .01 .2 .02 .1 .03 .5 100", std::sqrt(1 + 1 / .99 + .2 / .98 + .1 / .97 - .5 / 99)},
      {7, "2.5 .02 .1 .01", std::sqrt(2.5 + .02 / .9 - .01)},
      {8, "1.5 1 .1 .01", std::sqrt(1.5 + 1 / .9 - .01)},
      {9, "1.5 1 .1 .5 100", std::sqrt(1.5 + 1 / .9 - .5 / 99)},
      {10, "2 .1 .05 .02 .01 .005 .001 .001", std::sqrt(2.187)},
      {11, "1 .01 .2 .02 .1 .03 .05 .04 .5 100", std::sqrt(1 + 1 / .99 + .2 / .98 + .1 / .97 + .05 / .96 - .5 / 99)},
      {12, "2 .1 .05 .02 .01 .005 .001 .001", std::sqrt(2.187)},
      {13, "2 .1 .05 .02 .01 .005 .001 .001 .001", std::sqrt(2.188)}};
  for (Row const& row : rows) {
    GlassCatalogue catalogue;
    catalogue.add("NM X " + std::to_string(row.formula) + " 0 0 0\nCD " + row.coefficients + "\nLD 0.9 1.1\n", "TEST",
                  "test.agf");
    EXPECT_NEAR(catalogue.match("X", 1e-6, "here").glass->index(1e-6), row.index, 1e-14) << row.formula;
  }
}

// A damaged catalogue is refused, with the line of the error.
TEST(GlassCatalogue, RefusesWhatIsNoGlassAtItsLine) {
  auto const refusal = [](char const* text) { return error_of([&] { GlassCatalogue().add(text, "TEST", "x.agf"); }); };
  EXPECT_EQ(refusal("NM X 2 0\nCD 1 nan\nLD 0.4 0.7\n"), "missing_content at x.agf:2");
  EXPECT_EQ(refusal("\nNM X 99\nCD 1\nLD 0.4 0.7\n"), "missing_content at x.agf:2");
  EXPECT_EQ(refusal("NM X 2\nLD 0.4 0.7\n"), "missing_content at x.agf:1");
  EXPECT_EQ(refusal("NM X 2\nCD 1 .01\n"), "missing_content at x.agf:1");
  EXPECT_EQ(refusal("NM X 1\nCD 90\nLD 0.4 0.7\n"), "missing_content at x.agf:1");
  EXPECT_EQ(refusal("CC nothing here\n"), "missing_content at x.agf");
}

// The first one of two added catalogues is used, unless one of them is preferred; a note reports the choice if the
// indices differ.
TEST(GlassCatalogue, ANameOfDifferentGlassesIsNoted) {
  GlassCatalogue catalogue;
  catalogue.add("NM X 1\nCD 2.25\nLD 0.4 0.7\nNM Y 1\nCD 2.25\nLD 0.4 0.7\n", "ONE", "one.agf");
  catalogue.add("NM X 1\nCD 2.56\nLD 0.4 0.7\nNM Y 1\nCD 2.2501\nLD 0.4 0.7\n", "TWO", "two.agf");
  GlassMatch const first = catalogue.match("X", 5e-7, "here");
  EXPECT_NEAR(first.glass->index(5e-7), 1.5, 1e-15);
  EXPECT_THAT(first.notes,
              testing::ElementsAre(Warns("assumed at here", AllOf(HasSubstr("ONE:X"), HasSubstr("TWO:X")))));
  GlassMatch const preferred = catalogue.match("X", 5e-7, "here", {"two"});
  EXPECT_NEAR(preferred.glass->index(5e-7), 1.6, 1e-15);
  EXPECT_THAT(preferred.notes, testing::IsEmpty());
  EXPECT_THAT(catalogue.match("Y", 5e-7, "here").notes, testing::IsEmpty());  // both indices agree to 1e-4
  // two glasses of one name in one catalogue are distinguished by their lines
  catalogue.add("NM Z 1\nCD 2.25\nLD 0.4 0.7\nNM Z 1\nCD 2.56\nLD 0.4 0.7\n", "TWICE", "twice.agf");
  EXPECT_THAT(catalogue.match("Z", 5e-7, "here").notes,
              testing::ElementsAre(Warns(
                  "assumed at here", AllOf(HasSubstr("TWICE:Z (twice.agf:1)"), HasSubstr("TWICE:Z (twice.agf:4)")))));
  EXPECT_NEAR(catalogue.match("TWO:X", 5e-7, "here").glass->index(5e-7), 1.6, 1e-15);
  EXPECT_NEAR(catalogue.match("X_ONE", 5e-7, "here").glass->index(5e-7), 1.5, 1e-15);
}

// ONE is the first catalogue, but its glass X is defined in the visible range only.
TEST(GlassCatalogue, PassesOverACatalogueWhoseRangeEndsBeforeTheWavelength) {
  GlassCatalogue catalogue;
  catalogue.add("NM X 1\nCD 2.25\nLD 0.4 0.7\n", "ONE", "one.agf");
  catalogue.add("NM X 1\nCD 2.56\nLD 0.4 2\n", "TWO", "two.agf");
  EXPECT_EQ(catalogue.match("X", 5e-7, "here").glass->catalogue, "ONE");
  EXPECT_EQ(catalogue.match("X", 1.5e-6, "here").glass->catalogue, "TWO");
  EXPECT_EQ(catalogue.match("X", 1.5e-6, "here", {"ONE"}).glass->catalogue, "TWO") << "although the lens lists ONE";
  EXPECT_EQ(error_of([&] { catalogue.match("X", 3e-6, "here"); }), "out_of_range at here");
}

}  // namespace
}  // namespace gladstone
