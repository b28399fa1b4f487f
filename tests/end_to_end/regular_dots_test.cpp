#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

/// Regular dots, the standard target of BOS: a displacement is ambiguous by whole pitches.
class RegularDots : public ProgramFixture {
 protected:
  /// Renders dots 7.16 px apart, displaced by a uniform gradient, correlates and compares.
  /// @param gradient [kg/m^4]; -0.006627 px each with the set-up of Table 1
  nlohmann::json errors_for(double gradient_x, double gradient_y) const {
    write("regular.toml",
          with(with(with(automatic_setup(), "pixels = [64, 64]", "pixels = [128, 128]"),
                    "gradient_kg_m4 = [20.0, 10.0, 0.0]",
                    "gradient_kg_m4 = [" + std::to_string(gradient_x) + ", " + std::to_string(gradient_y) + ", 0.0]"),
               "dots_per_32px_window = 10.0", "dots_per_32px_window = 20.0\narrangement = \"regular\""));
    std::filesystem::remove_all(in("case"));
    render("case", {}, "regular.toml");
    gladstone({"correlate", "case", "--quiet"});
    succeed({"compare", "case", "--no-figures", "--quiet"});
    return nlohmann::json::parse(read("case/errors.json"))["ray_truth"];
  }
};

// 0.45 pitch is 3.2 px: up to there the smallest of all matching shifts is the correct one.
TEST_F(RegularDots, AreRightWithinNearlyHalfAPitch) {
  for (auto const& [x, y] : {std::pair{75.0, 0.0}, {-45.0, 30.0}, {0.0, -240.0}, {480.0, 0.0}}) {
    auto const errors = errors_for(x, y);
    EXPECT_LT(errors["gross_fraction"], 0.01) << x << ' ' << y;
    EXPECT_LT(errors["rms_px"], 0.05) << x << ' ' << y;
  }
}

// Beyond half a pitch an alias is a smaller shift: the correct one cannot be identified, and the vectors are marked as
// ambiguous.
TEST_F(RegularDots, AreFlaggedAmbiguous) {
  errors_for(620.0, 0.0);  // 4.1 px, 0.57 pitch
  auto const ambiguous = Hdf5Reader(in("case/vectors.h5").string()).read_integers("/ambiguous");
  auto const flagged = std::count(ambiguous.begin(), ambiguous.end(), 1);
  EXPECT_GT(static_cast<double>(flagged), 0.9 * static_cast<double>(ambiguous.size()));
}

}  // namespace
}  // namespace gladstone::end_to_end
