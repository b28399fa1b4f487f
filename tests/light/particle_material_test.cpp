#include "render/light/particle_material.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "render/base/error.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

std::complex<double> read_index(std::string const& keys, double wavelength = 532e-9) {
  SetupDocument document = SetupDocument::from_text("[particles]\n" + keys, "case.toml");
  std::complex<double> const index = read_particle_index(document.root().table("particles"), wavelength);
  document.finish();
  return index;
}

// Handbook values at the sodium line, 589.3 nm (CRC Handbook of Chemistry and Physics): water at 20 C 1.3330, rutile
// 2.613 and 2.909 (mean 2.712), sapphire 1.768 and 1.760 (mean 1.765), soda-lime glass 1.52, to all printed digits.
TEST(ParticleMaterial, HasTheIndexOfHandbooks) {
  double const sodium = 589.3e-9;
  EXPECT_NEAR(particle_material("water").index(sodium).real(), 1.3330, 5e-4);
  EXPECT_NEAR(particle_material("tio2").index(sodium).real(), 2.712, 5e-3);
  EXPECT_NEAR(particle_material("al2o3").index(sodium).real(), 1.765, 5e-4);
  EXPECT_NEAR(particle_material("glass").index(sodium).real(), 1.52, 5e-3);
  EXPECT_NEAR(particle_material("dehs").index(sodium).real(), 1.450, 5e-4);
  for (ParticleMaterial const& material : particle_materials()) {
    EXPECT_FALSE(material.source.empty());
    EXPECT_GE(material.index(450e-9).real(), material.index(650e-9).real()) << material.name;  // normal dispersion
  }
}

TEST(ParticleMaterial, IsNamedOrGivenByItsIndex) {
  EXPECT_EQ(read_index(""), 1.45);
  EXPECT_EQ(read_index("index = [1.5, 0.01]"), std::complex<double>(1.5, 0.01));
  EXPECT_EQ(read_index("material = \"oil\""), read_index("material = \"dehs\""));
  EXPECT_NEAR(read_index("material = \"water\"").real(), 1.3352, 2e-4);  // 532 nm
}

TEST(ParticleMaterial, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT([] { read_index("material = \"tio\""); }, ThrowsSetupError(ErrorCode::unknown_choice, "case.toml:2:1"));
  EXPECT_THAT([] { read_index("material = \"tio2\"", 355e-9); },
              ThrowsSetupError(ErrorCode::invalid_value, "case.toml:2:1"));
  EXPECT_THAT([] { read_index("material = \"water\"\nindex = [1.3, 0.0]"); },
              ThrowsSetupError(ErrorCode::invalid_value, "case.toml:3:1"));
  EXPECT_THAT([] { read_index("index = [0.0, 1.0]"); }, ThrowsSetupError(ErrorCode::invalid_value, "case.toml:2:1"));
  EXPECT_THAT([] { read_index("index = [1.5, -0.1]"); }, ThrowsSetupError(ErrorCode::out_of_range, "case.toml:2:1"));
}

}  // namespace
}  // namespace gladstone
