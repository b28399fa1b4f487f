#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scene/read_setup_text.h"

namespace gladstone {
namespace {

using ::testing::HasSubstr;

/// Returns the set-up of Table 1 with a medium of 10 mm and these windows, each "side, Z in mm, thickness in mm".
std::string bench(std::string const& windows) {
  return "[camera]\npixels = [128, 128]\n[lens]\nfocal_length_mm = 105.0\n[geometry]\nz_a_mm = 750.0\nz_d_mm = 250.0\n"
         "[medium]\nthickness_mm = 10.0\n[medium.field]\nkind = \"uniform_gradient\"\ngradient_kg_m4 = [1, 0, 0]\n" +
         windows;
}
std::string window(std::string const& side, double z_mm, double thickness_mm) {
  return "[[window]]\nside = \"" + side + "\"\nposition_mm = [0, 0, " + std::to_string(z_mm) +
         "]\nthickness_mm = " + std::to_string(thickness_mm) + "\n";
}

TEST(Windows, StandInTheOrderLightMeetsThem) {
  EXPECT_NO_THROW(read_setup_text(bench(window("target", -100, 20) + window("target", -50, 20) +
                                        // faces may be in contact
                                        window("camera", 50, 20) + window("camera", 70, 20))));
}

TEST(Windows, AreRefusedWhereTheyOverlapOtherObjects) {
  auto const errors = [](std::string const& windows) { return error_of([&] { read_setup_text(bench(windows)); }); };
  for (std::string const& misplaced :
       {window("target", -300, 10), window("target", 0, 20), window("camera", 0, 20), window("camera", -50, 10),
        window("camera", 745, 20), window("camera", 800, 20)}) {
    EXPECT_EQ(errors(misplaced), "invalid_value at case.toml:14:1") << misplaced;
  }
  EXPECT_EQ(errors(window("camera", 50, 20) + window("camera", 60, 20)), "invalid_value at case.toml:18:1");
}

TEST(Lens, IsRefusedWhereItsFirstVertexStandsInTheMedium) {
  std::string const lens = "[camera]\npixels = [128, 128]\n[lens]\nmodel = \"prescription\"\nfile = \"" +
                           std::string(GLADSTONE_DATA_DIR) +
                           "/lenses/double_gauss.toml\"\n[medium]\nthickness_mm = 10.0\n[medium.field]\n"
                           "kind = \"uniform_gradient\"\ngradient_kg_m4 = [1, 0, 0]\n[geometry]\nz_d_mm = 1250.0\n";
  // the principal plane is 70 mm behind the first vertex
  EXPECT_EQ(error_of([&] { read_setup_text(lens + "z_a_mm = 60.0\n"); }), "invalid_value at case.toml:13:1");
  EXPECT_NO_THROW(read_setup_text(lens + "z_a_mm = 100.0\n"));
}

}  // namespace
}  // namespace gladstone
