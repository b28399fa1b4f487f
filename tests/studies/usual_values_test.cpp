#include "studies/case/usual_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gladstone {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> unusual(std::string const& text) {
  SetupDocument document = SetupDocument::from_text(text, "setup.toml");
  return unusual_values(document);
}

// Each value would be usual in another unit: the message gives the key, its place and the unit.
TEST(UsualValues, NameTheUnitThatWasMistaken) {
  EXPECT_THAT(
      unusual("[lens]\nfocal_length_mm = 0.105\n"),
      ElementsAre("setup.toml:2:1: lens.focal_length_mm = 0.105 mm is outside the usual range, 2 to 20000 mm; is "
                  "it in m? 0.105 m are 105 mm"));
  EXPECT_THAT(unusual("[target]\ndot_diameter_mm = 0.000135\n"), ElementsAre(HasSubstr("are 0.135 mm")));
  EXPECT_THAT(unusual("[medium]\ngladstone_dale = 0.226\nwavelength_nm = 0.532\n"),
              ElementsAre(HasSubstr("0.532 um are 532 nm"), HasSubstr("0.226 cm^3/g are 0.000226 m^3/kg")));
  EXPECT_THAT(unusual("[flow]\ndt_us = 1e-5\nvelocity_m_s = [1e5, 0, 0]\n"),
              ElementsAre(HasSubstr("1e-05 s are 10 us"), HasSubstr("is it in mm/s")));
  EXPECT_THAT(unusual("[particles]\ndiameter_um = { kind = \"lognormal\", median_um = 1e-6, sigma = 0.2 }\n"),
              ElementsAre(HasSubstr("particles.diameter_um.median_um")));
  EXPECT_THAT(unusual("[[camera]]\npixel_pitch_um = 0.0045\n[camera.noise]\nfull_well_e = 3\n"),
              ElementsAre(HasSubstr("is it in mm? 0.0045 mm are 4.5 um"), HasSubstr("check its unit")));
}

// Zero and infinity have special meanings, and texts are ignored.
TEST(UsualValues, LeaveUsualValuesAlone) {
  EXPECT_THAT(unusual("[lens]\nfocal_length_mm = 105\nfocus_distance_mm = inf\n[medium]\ngladstone_dale = "
                      "\"ciddor\"\nambient_density_kg_m3 = 0\n[flow]\nvelocity_m_s = [0, 0, 0]\n"),
              IsEmpty());
}

}  // namespace
}  // namespace gladstone
