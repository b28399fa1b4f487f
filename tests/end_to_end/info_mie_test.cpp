#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

/// gladstone info mie: light scattering by a sphere.
class InfoMie : public ProgramFixture {};

// Bohren & Huffman's example, appendix A: x = 2 pi 0.525/0.6328, m = 1.55.
TEST_F(InfoMie, PrintsBohrenAndHuffmansExample) {
  auto const json = json_of({"info", "mie", "--x", "5.21281966857", "--m", "1.55"});
  EXPECT_NEAR(json["q_ext"], 3.10542553, 1e-8);
  EXPECT_NEAR(json["q_sca"], 3.10542553, 1e-8);
  EXPECT_NEAR(json["q_back"], 2.92534065, 1e-8);
  EXPECT_NEAR(json["g"], 0.633136758, 1e-8);
  auto const& s11 = json["s11"];
  ASSERT_EQ(s11.size(), 181u);
  EXPECT_EQ(s11[90][0], 90.0);
  EXPECT_NEAR(s11[90][1].get<double>() / s11[0][1].get<double>(), 0.012460081, 1e-9);
  EXPECT_NEAR(json["polarization"][90][1], 0.23046245, 1e-7);
  EXPECT_THAT(succeed({"info", "mie", "--x", "5.21281966857", "--m", "1.55"}), HasSubstr("extinction"));
}

// An absorbing sphere (Wiscombe 1979), and one whose ripples are finer than a degree: pi/x is 0.6 degrees at x = 300.
TEST_F(InfoMie, TakesAbsorptionAndFineRipples) {
  auto const json = json_of({"info", "mie", "--x", "1", "--m", "1.5,1"});
  EXPECT_NEAR(json["q_ext"], 2.33632098467, 1e-10);
  EXPECT_NEAR(json["q_sca"], 0.663453761516, 1e-11);
  auto const fine = json_of({"info", "mie", "--x", "300", "--m", "1.45"})["s11"];
  EXPECT_LE(fine[1][0].get<double>(), 0.6 / 8 + 1e-9);
  EXPECT_EQ(fine.back()[0], 180.0);
}

TEST_F(InfoMie, DrawsTheScatteredLight) {
  auto const json = json_of({"info", "mie", "--x", "5.9", "--m", "1.45", "--figure", "mie.png"});
  EXPECT_EQ(json["figure"], "mie.png");
  EXPECT_THAT(read("mie.png"), HasSubstr("PNG"));
  // nothing is scattered: the figure has only axes
  succeed({"info", "mie", "--x", "5.9", "--m", "1", "--figure", "nothing.png"});
  EXPECT_THAT(read("nothing.png"), HasSubstr("PNG"));
}

TEST_F(InfoMie, NamesWhatIsNoSphere) {
  expect_error({"info", "mie"}, 2, "arguments at info mie", {"--x", "--m"});
  expect_error({"info", "mie", "--x", "1"}, 2, "arguments at info mie", {"--x", "--m"});
  for (char const* x : {"0", "-1", "1e9"}) {
    expect_error({"info", "mie", "--x", x, "--m", "1.45"}, 2, "arguments at --x", {"1e-06 to 100000"});
  }
  for (char const* x : {"nan", "inf", "5.9um"}) {
    expect_error({"info", "mie", "--x", x, "--m", "1.45"}, 2, "arguments at --x", {std::string("\"") + x + '"'});
  }
  for (char const* m : {"0", "1e-160", "1.5,-0.1", "101"}) {
    expect_error({"info", "mie", "--x", "1", "--m", m}, 2, "arguments at --m");
  }
  for (char const* m : {"1.5,", "glass", "1,2,3"}) {
    expect_error({"info", "mie", "--x", "1", "--m", m}, 2, "arguments at --m", {"RE,IM"});
  }
  expect_error({"info", "mie", "sphere.toml", "--x", "1", "--m", "1.5"}, 2, "arguments at sphere.toml");
}

}  // namespace
}  // namespace gladstone::end_to_end
