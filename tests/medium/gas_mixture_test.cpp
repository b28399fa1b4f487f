#include "render/medium/gas_mixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "render/medium/gladstone_dale.h"
#include "render/medium/medium_setup.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

constexpr double green = 532e-9, sodium = 589.3e-9;

/// Returns fractions in the order of gases().
std::vector<double> fractions(std::map<std::string_view, double> const& given) {
  std::vector<double> all;
  for (Gas const& gas : gases()) all.push_back(given.contains(gas.name) ? given.at(gas.name) : 0);
  return all;
}

double constant_of_pure(std::string_view name, double wavelength) {
  return mixture_by_mass(fractions({{name, 1}})).gladstone_dale(wavelength);
}

MediumSetup medium_of(std::string const& text) {
  SetupDocument document = SetupDocument::from_text(text, "setup.toml");
  MediumSetup const setup = read_medium_setup(document.root().table("medium"));
  document.finish();
  return setup;
}

// Merzkirch, Flow Visualization (1987): K in cm^3/g at the wavelength of sodium, to three digits.
TEST(GasMixture, PureGasesHaveTheTabulatedConstants) {
  std::map<std::string_view, double> const table{{"helium", 0.196},  {"hydrogen", 1.55}, {"nitrogen", 0.238},
                                                 {"oxygen", 0.190},  {"argon", 0.158},   {"carbon_dioxide", 0.229},
                                                 {"methane", 0.617}, {"water", 0.310},   {"air", 0.226}};
  EXPECT_EQ(table.size(), gases().size());
  for (auto const& [name, constant] : table) {
    EXPECT_NEAR(constant_of_pure(name, sodium), 1e-3 * constant, 0.013 * 1e-3 * constant) << name;
  }
}

// Dry air: 78.084 % N2, 20.946 % O2, 0.934 % Ar, 0.036 % CO2 by moles. Ciddor's formula for air is an independent
// measurement.
TEST(GasMixture, CompositionOfAirGivesTheConstantOfAir) {
  GasMixture const air = mixture_by_moles(
      fractions({{"nitrogen", 0.78084}, {"oxygen", 0.20946}, {"argon", 0.00934}, {"carbon_dioxide", 0.00036}}));
  for (double const wavelength : {450e-9, green, sodium, 700e-9}) {
    EXPECT_NEAR(air.gladstone_dale(wavelength) / gladstone_dale_ciddor(wavelength), 1, 1e-4) << wavelength;
  }
  EXPECT_NEAR(air.molar_mass(), 28.96e-3, 0.01e-3);
}

// K = sum of Y_i K_i, and Y_i = X_i M_i / sum of X_j M_j.
TEST(GasMixture, IsLinearInTheMass) {
  double const helium = constant_of_pure("helium", green), air = constant_of_pure("air", green);
  GasMixture const by_mass = mixture_by_mass(fractions({{"helium", 0.25}, {"air", 0.75}}));
  EXPECT_NEAR(by_mass.gladstone_dale(green), 0.25 * helium + 0.75 * air, 1e-15);
  GasMixture const by_moles = mixture_by_moles(fractions({{"helium", 0.2}, {"air", 0.8}}));
  double const mass = 0.2 * 4.002602 + 0.8 * 28.9641;
  EXPECT_NEAR(by_moles.gladstone_dale(green), (0.2 * 4.002602 * helium + 0.8 * 28.9641 * air) / mass, 1e-15);
  EXPECT_NEAR(by_moles.molar_mass(), 1e-3 * mass, 1e-15);
}

TEST(GasMixture, IsReadFromASetup) {
  MediumSetup const air = medium_of("[medium]\ngas = { air = 1 }\n");
  EXPECT_NEAR(air.gladstone_dale, gladstone_dale_ciddor(green), 1e-18);
  MediumSetup const mass = medium_of("[medium.gas]\nfractions = \"mass\"\nhelium = 0.25\nair = 0.75\n");
  EXPECT_NEAR(mass.gladstone_dale, mixture_by_mass(fractions({{"helium", 0.25}, {"air", 0.75}})).gladstone_dale(green),
              1e-18);
  EXPECT_FALSE(medium_of("[medium]\n").gas);
}

TEST(GasMixture, RefusesWhatIsNoMixture) {
  auto const errors = [](std::string const& text) { return error_of([&] { medium_of(text); }); };
  EXPECT_EQ(errors("[medium]\ngas = { helium = 0.2, air = 0.7 }\n"), "invalid_value at setup.toml:2:1");
  EXPECT_EQ(errors("[medium]\ngas = {}\n"), "invalid_value at setup.toml:2:1");
  EXPECT_EQ(errors("[medium]\ngas = { air = 1 }\ngladstone_dale = 2.26e-4\n"), "invalid_value at setup.toml:3:1");
  EXPECT_EQ(errors("[medium]\nwavelength_nm = 1064\ngas = { air = 1 }\n"), "invalid_value at setup.toml:3:1");
  EXPECT_EQ(errors("[medium]\ngas = { helium = 1.5 }\n"), "out_of_range at setup.toml:2:9");
  // The sum of the fractions is unknown if one of them is wrong.
  EXPECT_EQ(errors("[medium]\ngas = { helium = \"much\", air = 0.7 }\n"), "wrong_type at setup.toml:2:9");
  EXPECT_EQ(errors("[medium.gas]\nCO2 = 0.2\nair = 0.8\n"), "unknown_key at setup.toml:2:1");
  // A formula, in upper or lower case, is reported with the name of its gas.
  auto const suggests = [](std::string const& written, std::string const& gas) {
    return testing::AllOf(ThrowsSetupError(ErrorCode::unknown_key, "medium.gas." + written),
                          testing::ThrowsMessage<SetupError>(testing::HasSubstr('"' + gas + '"')));
  };
  EXPECT_THAT([] { medium_of("[medium.gas]\nco2 = 0.2\nair = 0.8\n"); }, suggests("co2", "carbon_dioxide"));
  EXPECT_THAT([] { medium_of("[medium.gas]\nHe = 1\n"); }, suggests("He", "helium"));
  EXPECT_THAT([] { medium_of("[medium]\ngas = { helum = 1 }\n"); }, suggests("helum", "helium"));
}

// The resolved setup of a case reads back to the same constant.
TEST(GasMixture, ResolvedSetupReadsBack) {
  SetupDocument document = SetupDocument::from_text("[medium]\ngas = { helium = 0.2, air = 0.8 }\n", "setup.toml");
  double const constant = read_medium_setup(document.root().table("medium")).gladstone_dale;
  EXPECT_EQ(medium_of(document.resolved()).gladstone_dale, constant);
}

}  // namespace
}  // namespace gladstone
