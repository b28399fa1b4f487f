#include "studies/case/usual_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Warnings unusual(std::string const& text) {
  SetupDocument document = SetupDocument::from_text(text, "setup.toml");
  return unusual_values(document);
}

// Each value would be usual in another unit: the message gives the key, its place and the unit.
TEST(UsualValues, NameTheUnitThatWasMistaken) {
  EXPECT_THAT(unusual("[lens]\nfocal_length_mm = 0.105\n"),
              ElementsAre(Warns("implausible at setup.toml:2:1",
                                AllOf(HasSubstr("2 to 20000 mm"), HasSubstr("0.105 m "), HasSubstr("105 mm")))));
  EXPECT_THAT(unusual("[target]\ndot_diameter_mm = 0.000135\n"),
              ElementsAre(Warns("implausible at setup.toml:2:1", HasSubstr("0.135 mm"))));
  EXPECT_THAT(unusual("[medium]\ngladstone_dale = 0.226\nwavelength_nm = 0.532\n"),
              ElementsAre(Warns("implausible at setup.toml:3:1", AllOf(HasSubstr("0.532 um"), HasSubstr("532 nm"))),
                          Warns("implausible at setup.toml:2:1",
                                AllOf(HasSubstr("0.226 cm^3/g"), HasSubstr("0.000226 m^3/kg")))));
  EXPECT_THAT(unusual("[flow]\ndt_us = 1e-5\nvelocity_m_s = [1e5, 0, 0]\n"),
              ElementsAre(Warns("implausible at setup.toml:2:1", AllOf(HasSubstr("1e-05 s"), HasSubstr("10 us"))),
                          Warns("implausible at setup.toml:3:1", HasSubstr("mm/s"))));
  EXPECT_THAT(unusual("[particles]\ndiameter_um = { kind = \"lognormal\", median_um = 1e-6, sigma = 0.2 }\n"),
              ElementsAre(Warns("implausible at setup.toml:2:37", HasSubstr("particles.diameter_um.median_um"))));
  EXPECT_THAT(unusual("[[camera]]\npixel_pitch_um = 0.0045\n[camera.noise]\nfull_well_e = 3\n"),
              ElementsAre(Warns("implausible at setup.toml:2:1", AllOf(HasSubstr("0.0045 mm"), HasSubstr("4.5 um"))),
                          Warns("implausible at setup.toml:4:1")));
}

// Zero and infinity have special meanings, and texts are ignored.
TEST(UsualValues, LeaveUsualValuesAlone) {
  EXPECT_THAT(unusual("[lens]\nfocal_length_mm = 105\nfocus_distance_mm = inf\n[medium]\ngladstone_dale = "
                      "\"ciddor\"\nambient_density_kg_m3 = 0\n[flow]\nvelocity_m_s = [0, 0, 0]\n"),
              IsEmpty());
}

}  // namespace
}  // namespace gladstone
