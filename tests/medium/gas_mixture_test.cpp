#include "render/medium/gas_mixture.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "render/medium/gladstone_dale.h"
#include "render/medium/medium_setup.h"

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
  auto const problem = [](std::string const& text) -> std::string {
    try {
      medium_of(text);
    } catch (SetupError const& error) {
      return error.what();
    }
    return "";
  };
  auto const names = [&](std::string const& text, std::string const& piece) {
    EXPECT_NE(problem(text).find(piece), std::string::npos) << text << problem(text);
  };
  names("[medium]\ngas = { helium = 0.2, air = 0.7 }\n", "add up to 0.9");
  names("[medium]\ngas = {}\n", "add up to 0");
  names("[medium]\ngas = { air = 1 }\ngladstone_dale = 2.26e-4\n", "conflicts with medium.gas");
  names("[medium]\ngas = { helum = 1 }\n", "helium");
  names("[medium]\ngas = { helium = 1.5 }\n", "helium");
  names("[medium.gas]\nco2 = 0.2\nair = 0.8\n", "did you mean \"carbon_dioxide\"?");
  names("[medium.gas]\nHe = 1\n", "did you mean \"helium\"?");
  std::string const formula = problem("[medium.gas]\nCO2 = 0.2\nair = 0.8\n");
  EXPECT_EQ(formula.find("unknown key"), formula.rfind("unknown key")) << "reported once: " << formula;
  EXPECT_EQ(problem("[medium]\ngas = { helium = \"much\", air = 0.7 }\n").find("add up"), std::string::npos)
      << "the sum of the fractions is unknown if one of them is wrong";
  names("[medium]\nwavelength_nm = 1064\ngas = { air = 1 }\n", "from 400 to 800 nm");
}

// The resolved setup of a case reads back to the same constant.
TEST(GasMixture, ResolvedSetupReadsBack) {
  SetupDocument document = SetupDocument::from_text("[medium]\ngas = { helium = 0.2, air = 0.8 }\n", "setup.toml");
  double const constant = read_medium_setup(document.root().table("medium")).gladstone_dale;
  EXPECT_EQ(medium_of(document.resolved()).gladstone_dale, constant);
}

}  // namespace
}  // namespace gladstone
