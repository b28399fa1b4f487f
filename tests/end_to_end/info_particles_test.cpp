#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

/// gladstone info particles: predictions for a PIV setup.
class InfoParticles : public ProgramFixture {
 protected:
  static constexpr char const* piv_setup = R"(schema = 1
experiment = "piv"
[camera]
pixels = [128, 128]
pixel_pitch_um = 5.0
[lens]
focal_length_mm = 105.0
f_number = 8.0
[geometry]
z_a_mm = 750.0
[medium.field]
kind = "none"
[particles]
number = 2000
volume_mm = [10.0, 10.0, 1.0]
[flow]
kind = "uniform"
velocity_m_s = [1.0, 0.0, 0.0]
dt_us = 10.0
[correlate]
window_px = [64, 32]
)";
};

// 2000 in 10 x 10 x 1 mm, all within the sheet of 1 mm: 20 per mm^2, and 32 px are 32 x 5 um / M, M = 105/645.
TEST_F(InfoParticles, TellsWhatToExpect) {
  write("piv.toml", piv_setup);
  auto const json = json_of({"info", "particles", "piv.toml"});
  double const window_mm = 32 * 5e-3 / (105.0 / 645);
  EXPECT_EQ(json["particles_per_window"][1][0], 32);
  EXPECT_NEAR(json["particles_per_window"][1][1], 20 * window_mm * window_mm, 1e-6);
  EXPECT_NEAR(json["photons"]["median"], 45443, 454);
  EXPECT_GT(json["depth_of_field_mm"], 0);
  std::string const text = succeed({"info", "particles", "piv.toml"});
  EXPECT_THAT(text, HasSubstr("image diameter"));
  EXPECT_THAT(text, ContainsWhole("in 32 px"));
}

TEST_F(InfoParticles, IsOfPivAlone) {
  expect_error({"info", "particles", "setup.toml"}, 2, "wrong_format at setup.toml");
  expect_error({"info", "particles"}, 2, "arguments at info particles");
}

}  // namespace
}  // namespace gladstone::end_to_end
