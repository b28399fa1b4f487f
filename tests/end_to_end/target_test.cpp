#include <regex>
#include <sstream>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;
using Points = std::vector<std::pair<double, double>>;

/// gladstone target: the dot pattern of a setup for printing.
class Target : public ProgramFixture {
 protected:
  /// Returns the first two numbers of every match of a pattern in a file.
  Points found(std::string const& name, std::string const& pattern) const {
    Points points;
    std::string const text = read(name);
    std::regex const expression(pattern);
    for (auto at = std::sregex_iterator(text.begin(), text.end(), expression); at != std::sregex_iterator(); ++at) {
      points.emplace_back(std::stod((*at)[1]), std::stod((*at)[2]));
    }
    return points;
  }
  Points table(std::string const& name) const { return found(name, "([-0-9.e]+),([-0-9.e]+)\n"); }
};

// The renderer traces these dots: the truth of a case lists their places.
TEST_F(Target, HasTheDotsOfTheRenderer) {
  auto const json = json_of({"target", "setup.toml", "-o", "dots.csv"});
  render("case");
  auto const position = Hdf5Reader(in("case/truth.h5").string()).read("/dots/position_m");
  Points const dots = table("dots.csv");
  ASSERT_EQ(3 * dots.size(), position.size());
  EXPECT_EQ(json["dots"], dots.size());
  for (std::size_t i = 0; i < dots.size(); ++i) {
    EXPECT_NEAR(dots[i].first, 1e3 * position[3 * i], 1e-9);
    EXPECT_NEAR(dots[i].second, 1e3 * position[3 * i + 1], 1e-9);
  }
  // three pixels of 10 um by the magnification 105/895
  EXPECT_NEAR(json["dot_diameter_mm"], 3 * 0.01 * 895 / 105, 1e-9);
}

// Differences of places on the page are those on the target, with y downwards (SVG) and upwards (PDF).
TEST_F(Target, IsAtTrueScale) {
  succeed({"target", "setup.toml", "-o", "dots.csv"});
  auto const json = json_of({"target", "setup.toml", "-o", "dots.svg"});
  succeed({"target", "setup.toml", "-o", "dots.pdf"});
  Points const dots = table("dots.csv"), svg = found("dots.svg", "cx=\"([-0-9.]+)\" cy=\"([-0-9.]+)\"");
  Points const pdf = found("dots.pdf", "q 1 0 0 1 ([-0-9.]+) ([-0-9.]+) cm /Dot Do Q");
  ASSERT_EQ(svg.size(), dots.size());
  ASSERT_EQ(pdf.size(), dots.size());
  for (std::size_t i = 1; i < dots.size(); ++i) {
    EXPECT_NEAR(svg[i].first - svg[0].first, dots[i].first - dots[0].first, 2e-5);
    EXPECT_NEAR(svg[i].second - svg[0].second, dots[0].second - dots[i].second, 2e-5);
    EXPECT_NEAR(pdf[i].first - pdf[0].first, dots[i].first - dots[0].first, 2e-5);
    EXPECT_NEAR(pdf[i].second - pdf[0].second, dots[i].second - dots[0].second, 2e-5);
  }
  // the page in mm, and in points of 1/72 inch
  double const width = json["page_mm"][0], height = json["page_mm"][1];
  auto const box = found("dots.pdf", R"(MediaBox \[0 0 ([0-9.]+) ([0-9.]+)\])").at(0);
  EXPECT_NEAR(box.first, width * 72 / 25.4, 1e-4);
  EXPECT_NEAR(box.second, height * 72 / 25.4, 1e-4);
  auto const size = found("dots.svg", "width=\"([0-9.]+)mm\" height=\"([0-9.]+)mm\"").at(0);
  EXPECT_NEAR(size.first, width, 1e-5);
  EXPECT_NEAR(size.second, height, 1e-5);
  for (auto const& [x, y] : svg) {
    EXPECT_TRUE(x > 0 && x < width && y > 0 && y < height);
  }
}

// The table of cross references of a PDF holds the offset of every object.
TEST_F(Target, PdfHasAValidTableOfObjects) {
  succeed({"target", "setup.toml", "-o", "dots.pdf"});
  std::string const text = read("dots.pdf");
  EXPECT_TRUE(text.starts_with("%PDF-1.4\n"));
  EXPECT_TRUE(text.ends_with("%%EOF\n"));
  auto const table = text.find("\nxref\n") + 1;
  EXPECT_THAT(text, HasSubstr("startxref\n" + std::to_string(table) + "\n"));
  std::istringstream lines(text.substr(table));
  std::string line;
  for (int skipped = 0; skipped < 3; ++skipped) std::getline(lines, line);
  for (int object = 1; object <= 6; ++object) {
    std::getline(lines, line);
    EXPECT_EQ(text.substr(std::stoul(line), 8), std::to_string(object) + " 0 obj\n") << line;
  }
}

// Dark dots are black on white paper; bright ones are white on black.
TEST_F(Target, FollowsThePolarity) {
  succeed({"target", "setup.toml", "-o", "bright.svg"});
  succeed({"target", "setup.toml", "-o", "dark.svg", "--set", "target.polarity=dark"});
  EXPECT_THAT(read("bright.svg"), HasSubstr("<g fill=\"white\">"));
  EXPECT_THAT(read("dark.svg"), HasSubstr("<g fill=\"black\">"));
}

// The table can be given back as a target of points: the same dots in the same places.
TEST_F(Target, TableIsATargetOfPoints) {
  succeed({"target", "setup.toml", "-o", "dots.csv"});
  write("points.toml", with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""));
  auto const json = json_of({"target", "points.toml", "-o", "again.csv"});
  EXPECT_EQ(read("again.csv").size() > 0, true);
  EXPECT_EQ(table("again.csv").size(), table("dots.csv").size());
  EXPECT_NEAR(json["dot_diameter_mm"], 3 * 0.01 * 895 / 105, 1e-9);
}

TEST_F(Target, RefusesWhatHasNoDots) {
  succeed({"init", "piv", "-o", "piv.toml"});
  expect_error({"target", "piv.toml", "-o", "dots.svg"}, 2, "wrong_format at piv.toml");
  expect_error({"target", "setup.toml", "-o", "dots.png"}, 2, "output at dots.png");
  expect_error({"target", "setup.toml", "-o", "setup.toml"}, 2, "output at setup.toml");
  expect_error({"target", "setup.toml"}, 2, "arguments at --output");
  expect_error({"target", "setup.toml", "-o", "dots.svg", "--set", "target.dot_diameter_mm=0"}, 2,
               "out_of_range at target.dot_diameter_mm");
}

TEST_F(Target, NeverReplacesAnInput) {
  succeed({"target", "setup.toml", "-o", "dots.csv"});
  write("points.toml", with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""));
  expect_error({"target", "points.toml", "-o", "dots.csv"}, 2, "overwrites_input at dots.csv");
}

}  // namespace
}  // namespace gladstone::end_to_end
