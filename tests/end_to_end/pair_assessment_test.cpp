#include <cmath>
#include <random>

#include "render/base/vec.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Image of a camera: Gaussian dots of 3 px (e^-2) at random positions, 150 grey levels high.
struct Scene {
  int pixels;
  double dots_per_32px_window = 20.0;
  double noise = 0.0;  ///< standard deviation [grey levels]
};

/// The result of the decorrelation test is reported to the user.
class PairOfFrames : public ProgramFixture {
 protected:
  void write_frames(Scene const& scene, Vec2d displacement) const {
    std::mt19937 dots(1);
    constexpr double margin = 50.0;
    double const side = scene.pixels + 2.0 * margin;
    std::vector<Vec2d> places(static_cast<std::size_t>(scene.dots_per_32px_window / 1024.0 * side * side));
    auto const along = [&] { return side * static_cast<double>(dots()) * 0x1p-32 - margin; };
    for (Vec2d& place : places) place = {along(), along()};
    write_frame("a.tif", scene, places, -0.5 * displacement);
    write_frame("b.tif", scene, places, 0.5 * displacement);
  }
  Outcome correlate(std::string const& output, std::vector<std::string> const& more = {}) const {
    std::vector<std::string> arguments{"correlate", "a.tif", "b.tif", "-o", output, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return gladstone(arguments);
  }

  /// Columns of a .csv file by name.
  std::map<std::string, std::vector<double>> columns_of(std::string const& name) const {
    std::istringstream text(read(name));
    std::string line, field;
    std::vector<std::string> names;
    std::map<std::string, std::vector<double>> columns;
    std::getline(text, line);
    for (std::istringstream header(line); std::getline(header, field, ',');) names.push_back(field);
    while (std::getline(text, line)) {
      std::istringstream row(line);
      for (auto const& column : names) {
        std::getline(row, field, ',');
        columns[column].push_back(std::strtod(field.c_str(), nullptr));
      }
    }
    return columns;
  }
  std::vector<double> column_of(std::string const& file, std::string const& name) const {
    return columns_of(file).at(name);
  }

 private:
  void write_frame(std::string const& name, Scene const& scene, std::vector<Vec2d> const& places, Vec2d shift) const {
    constexpr int reach = 5;
    constexpr double sigma = 0.75;
    Image<double> grey(scene.pixels, scene.pixels, 1000.0);
    for (Vec2d const place : places) {
      Vec2d const at = place + shift;
      int const column = static_cast<int>(std::lround(at.x)), row = static_cast<int>(std::lround(at.y));
      for (int j = std::max(0, row - reach); j <= std::min(scene.pixels - 1, row + reach); ++j)
        for (int i = std::max(0, column - reach); i <= std::min(scene.pixels - 1, column + reach); ++i)
          grey(i, j) += 150.0 * std::exp(-0.5 * ((i - at.x) * (i - at.x) + (j - at.y) * (j - at.y)) / (sigma * sigma));
    }
    std::mt19937 bits(shift.x < 0.0 ? 2 : 3);
    std::normal_distribution<double> noise(0.0, 1.0);
    Image<std::uint16_t> image(scene.pixels, scene.pixels);
    std::transform(grey.begin(), grey.end(), image.begin(),
                   [&](double v) { return static_cast<std::uint16_t>(std::lround(v + scene.noise * noise(bits))); });
    write_tiff(in(name).string(), image, {});
  }
};

// A displacement of 40 px with a search radius of 32 px in the first pass.
TEST_F(PairOfFrames, ShiftedBeyondTheSearchRangeIsNoMeasurement) {
  write_frames({.pixels = 200}, {40.0, 0.0});
  Outcome const outcome = correlate("v.csv");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  auto const json = nlohmann::json::parse(outcome.out);
  EXPECT_THAT(warnings_in(json), testing::ElementsAre("unreliable"));
  EXPECT_EQ(json["verdict_code"], "uncorrelated");
  EXPECT_EQ(json["valid"], 0);
  EXPECT_EQ(json["replaced"], 0);
  auto const columns = columns_of("v.csv");
  for (double const u : columns.at("u_px")) EXPECT_TRUE(std::isnan(u));
  EXPECT_GT(std::count(columns.at("reason").begin(), columns.at("reason").end(), 7.0), 288);
}

TEST_F(PairOfFrames, OfASmallRealDisplacementIsBelieved) {
  write_frames({.pixels = 96, .noise = 7.5}, {0.02, 0.0});
  Outcome const outcome = correlate("v.h5");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, Not(HasSubstr("warning")));
  auto const json = nlohmann::json::parse(outcome.out);
  EXPECT_GT(json["vectors"], 90);
  EXPECT_EQ(json["valid"], json["vectors"]);
  EXPECT_EQ(json["verdict_code"], "correlates");
  Hdf5Reader const file(in("v.h5").string());
  EXPECT_EQ(file.attribute("verdict_code"), "correlates");
  EXPECT_EQ(file.attribute("uncertainty_method"), "correlation_statistics");
  EXPECT_EQ(file.attribute("uncertainty_key"), "correlate.uncertainty = \"auto\"");
  for (char const* key : {"uncertainty_method", "uncertainty_key"}) EXPECT_EQ(json[key], file.attribute(key)) << key;
}

TEST_F(PairOfFrames, GivenTwiceIsWarnedOf) {
  write_frames({.pixels = 96}, {});
  std::filesystem::copy_file(in("a.tif"), in("b.tif"), std::filesystem::copy_options::overwrite_existing);
  Outcome const outcome = correlate("v.h5");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(warnings_in(nlohmann::json::parse(outcome.out)), testing::ElementsAre("unreliable"));
  Hdf5Reader const file(in("v.h5").string());
  EXPECT_EQ(file.attribute("warning_codes"), "unreliable ");
  EXPECT_EQ(file.attribute("verdict_code"), "identical_frames");
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["verdict"], file.attribute("verdict"));
}

// Few dots in noise: every kind of vector occurs. Text and HDF5 files agree on each.
TEST_F(PairOfFrames, SaysOfEveryVectorHowItCameAbout) {
  write_frames({.pixels = 200, .dots_per_32px_window = 6.0, .noise = 15.0}, {2.3, -0.2});
  ASSERT_EQ(correlate("v.csv").exit_code, 0);
  ASSERT_EQ(correlate("v.h5").exit_code, 0);
  auto const columns = columns_of("v.csv");
  EXPECT_EQ(columns.size(), 13u);
  Hdf5Reader const file(in("v.h5").string());
  for (auto const& [name, values] : columns) {
    auto const others = file.read("/" + name);
    ASSERT_EQ(values.size(), others.size()) << name;
    for (std::size_t i = 0; i < values.size(); ++i)
      EXPECT_TRUE(values[i] == others[i] || (std::isnan(values[i]) && std::isnan(others[i]))) << name << ' ' << i;
  }
  std::map<double, int> reasons;
  for (std::size_t i = 0; i < columns.at("u_px").size(); ++i) {
    double const u = columns.at("u_px")[i], raw = columns.at("u_raw_px")[i], reason = columns.at("reason")[i],
                 status = columns.at("status")[i], correlation = columns.at("correlation")[i];
    ++reasons[reason];
    EXPECT_EQ(status, reason == 0 ? 0 : (reason <= 2 ? 1 : (reason == 3 ? 2 : 3))) << i;
    EXPECT_EQ(std::isnan(u), status >= 2) << i;
    if (reason == 0) {
      EXPECT_EQ(u, raw) << i;
    }
    EXPECT_EQ(std::isnan(correlation), std::isnan(raw)) << i;
    if (!std::isnan(raw)) {
      EXPECT_TRUE(correlation > 0.0 && correlation <= 1.0) << i;
    }
  }
  EXPECT_GT(reasons[0], 288);
  EXPECT_GT(reasons[1] + reasons[2], 0);
}

TEST_F(PairOfFrames, AreMeasuredWithinTheLimitThatIsSet) {
  write_frames({.pixels = 96}, {6.0, 0.0});
  Outcome const enough = correlate("v.csv", {"--set", "correlate.max_displacement_px=6.5"});
  EXPECT_EQ(enough.exit_code, 0);
  EXPECT_THAT(warnings_in(nlohmann::json::parse(enough.out)), testing::IsEmpty());
  for (double const u : column_of("v.csv", "u_px")) EXPECT_NEAR(u, 6.0, 0.1);
  Outcome const little = correlate("v.csv", {"--set", "correlate.max_displacement_px=4"});
  EXPECT_EQ(little.exit_code, 1);
  EXPECT_THAT(nlohmann::json::parse(little.out)["warnings"].dump(), ContainsWhole("correlate.max_displacement_px = 4"));
  EXPECT_THAT(warnings_in(nlohmann::json::parse(little.out)), testing::Contains(StartsWith("unreliable")));
  for (double const u : column_of("v.csv", "u_raw_px")) EXPECT_FALSE(std::abs(u) > 4.0) << u;
}

TEST_F(PairOfFrames, AreNotMeasuredWithALimitThatIsNone) {
  write_frames({.pixels = 96}, {});
  std::string const text = "[correlate]\nwindow_px = [32]\nmax_displacement_px = -3\n";
  write("limit.toml", text);
  expect_error({"correlate", "a.tif", "b.tif", "-o", "v.csv", "--config", "limit.toml"}, 2,
               "out_of_range at limit.toml:3:1");
  using Wrong = std::pair<std::string, std::string>;
  for (auto const& [value, code] :
       {Wrong{"0", "out_of_range"}, Wrong{"600", "out_of_range"}, Wrong{"nan", "out_of_range"},
        Wrong{"inf", "out_of_range"}, Wrong{"all", "unknown_choice"}, Wrong{"[3]", "wrong_type"}}) {
    expect_error({"correlate", "a.tif", "b.tif", "-o", "v.csv", "--set", "correlate.max_displacement_px=" + value}, 2,
                 code + " at --set correlate.max_displacement_px=" + value);
  }
}

}  // namespace
}  // namespace gladstone::end_to_end
