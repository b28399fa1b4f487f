#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "render/base/error.h"
#include "render/files/image_file.h"
#include "studies/drawing/draw_figure.h"
#include "studies/drawing/gnuplot.h"
#include "studies/figures/agreement_figure.h"
#include "studies/figures/density_figure.h"
#include "studies/figures/error_figures.h"
#include "studies/figures/map_figures.h"
#include "tests/support/expect_error.h"
#include "tests/support/folder_fixture.h"

namespace gladstone {
namespace {

class Figures : public FolderFixture {
 protected:
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }
};

/// Number of pixels darker than 30 % grey in the upper and in the lower half of an image.
struct DarkPixels {
  int upper = 0;
  int lower = 0;
};
DarkPixels dark_pixels(std::string const& path) {
  Image<double> const picture = read_image(path);
  DarkPixels dark;
  for (int row = 0; row < picture.rows(); ++row) {
    for (int column = 0; column < picture.columns(); ++column) {
      if (picture(column, row) < 0.3 * 255.0) ++(2 * row < picture.rows() ? dark.upper : dark.lower);
    }
  }
  return dark;
}

/// Zero (dark violet) in the upper rows, one (yellow) in the lower ones.
MapPanel half_dark() {
  MapPanel panel;
  panel.title = "it's a test_title [px]";
  panel.scale = ColourScale::magnitude;
  panel.map = Image<double>(40, 40, 0.0);
  for (int row = 20; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) panel.map(column, row) = 1.0;
  }
  return panel;
}

// The map is 330 px wide and half of it is dark: more than 330 x 165 x 0.9 dark pixels above, and only frame and text
// below.
TEST_F(Figures, MapsHaveRowZeroAtTheTop) {
  MapAxes const pixels{0.0, 1.0, 0.0, 1.0, true, "x [px]", "y [px]"};
  MapAxes const world{-20.0, 1.0, 20.0, -1.0, false, "x [mm]", "y [mm]"};
  for (MapAxes const& axes : {pixels, world}) {
    MapFigure figure;
    figure.columns = 1;
    figure.axes = axes;
    figure.panels = {half_dark()};
    draw_figure(make_map_figure(figure), in_folder("map.png"));
    DarkPixels const dark = dark_pixels(in_folder("map.png"));
    EXPECT_GT(dark.upper, 49000);
    EXPECT_LT(dark.lower, 8000);
  }
  EXPECT_EQ(files(), 1u);
}

TEST_F(Figures, ConstantAndMissingMapsAreDrawn) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  NamedMaps const constant{"truth", Image<double>(8, 4, 0.0), Image<double>(8, 4, 2.0)};
  NamedMaps const missing{"measurement", Image<double>(8, 4, nan), Image<double>(8, 4, nan)};
  draw_figure(make_displacement_maps("title", {}, {constant, missing}), in_folder("maps.png"));
  Image<double> const picture = read_image(in_folder("maps.png"));
  EXPECT_GT(picture.columns(), 700);
}

TEST_F(Figures, SeedFigure4HasFiveColumnsAndTwoRowsAnInstant) {
  Image<double> map(16, 16, 1.0);
  map(3, 3) = -1.0;
  SeedFigure4Instant const instant{"t = 1", map, map, map, {"Eq. 9", map, map}, {"cone", map, map}, {"rays", map, map}};
  draw_figure(make_seed_figure4({}, {instant}), in_folder("one.png"));
  draw_figure(make_seed_figure4({}, {instant, instant}), in_folder("two.png"));
  Image<double> const one = read_image(in_folder("one.png"));
  Image<double> const two = read_image(in_folder("two.png"));
  EXPECT_EQ(one.columns(), two.columns());
  EXPECT_GT(one.columns(), 5 * 200);
  EXPECT_GT(two.rows() - one.rows(), 2 * 200);
}

TEST_F(Figures, AgreementHasAPanelForCorrelationAndOneForTheRatio) {
  AgreementSeries series{"t = 1", {{0.5, 256, {0.5, 0.4}, {0.01, 0.02}}, {2, 64, {0.95, 0.8}, {0.01, 0.02}}}, {}};
  for (double const size : agreement_sizes()) series.prediction.push_back({size, {size / 10, size / 12}});
  draw_figure(make_agreement_figure({series, series}, std::vector<double>(agreement_sizes().size(), 0.5)),
              in_folder("agreement.png"));
  EXPECT_GT(read_image(in_folder("agreement.png")).columns(), 1000);
  EXPECT_DOUBLE_EQ(agreement_sizes().front(), 0.2);
  EXPECT_NEAR(agreement_sizes().back(), 10, 1e-12);
}

TEST_F(Figures, ErrorFiguresAreDrawnAlsoOfNothing) {
  DisplacementField truth;
  truth.columns = truth.rows = 20;
  ErrorSeries series{"against truth", {}};
  for (int i = 0; i < 400; ++i) {
    truth.position_px.push_back({8.0 * (i % 20), 8.0 * (i / 20)});
    truth.displacement_px.push_back({1e-4 * i * i, 0.0});
    series.error_px.push_back({0.01 * std::sin(i), 0.02 * std::cos(1.3 * i)});
  }
  ErrorSeries const nothing{"against nothing",
                            std::vector<Vec2d>(400, Vec2d{std::numeric_limits<double>::quiet_NaN(), 0.0})};
  draw_figure(make_error_histograms("errors", {series, nothing}), in_folder("histogram.png"));
  draw_figure(make_error_against_gradient("errors", truth, {series, nothing}), in_folder("gradient.png"));
  std::vector<BudgetStage> const stages{{"eq9", std::vector<Vec2d>(400)}, {"measured", series.error_px}};
  draw_figure(make_budget_bars("budget", error_budget(stages, VectorMask(400, 1))), in_folder("budget.png"));
  for (char const* name : {"histogram.png", "gradient.png", "budget.png"}) {
    EXPECT_GT(read_image(in_folder(name)).columns(), 700) << name;
  }
  EXPECT_EQ(files(), 3u);
}

TEST_F(Figures, AbsentGnuplotIsNamedWithItsPackage) {
  std::string const before = ::getenv("PATH") != nullptr ? ::getenv("PATH") : "";
  ::setenv("PATH", in_folder("").c_str(), 1);
  EXPECT_THROW(
      draw_figure({.width_px = 100, .height_px = 100, .panels = {{.box = {10, 90, 10, 90}}}}, in_folder("x.png")),
      GnuplotMissing);
  ::setenv("PATH", before.c_str(), 1);
  EXPECT_EQ(files(), 0u);
}

TEST_F(Figures, FailureLeavesTheOldPicture) {
  std::ofstream(in_folder("x.png")) << "old";
  GnuplotScript script;
  script.command("plot nonsense(");
  EXPECT_THAT([&] { script.write(in_folder("x.png"), 100, 100, "'DejaVu Sans,11'"); }, ThrowsOutputError("x.png"));
  std::string text;
  std::ifstream(in_folder("x.png")) >> text;
  EXPECT_EQ(text, "old");
  EXPECT_EQ(files(), 1u);
}

TEST_F(Figures, AFolderThatCannotBeIsAnOutputError) {
  std::ofstream(in_folder("file")) << "no folder";
  EXPECT_THROW(draw_figure({.width_px = 100, .height_px = 100}, in_folder("file/x.png")), OutputError);
}

// d = A x with A = [[3, 0], [4, 5]] / 1000: A^T A = [[25, 20], [20, 25]] / 1e6 has eigenvalues 45e-6 and 5e-6.
// Differences of a linear field are exact: rounding only.
TEST(LocalGradient, IsTheLargestSingularValue) {
  DisplacementField field;
  field.columns = 4;
  field.rows = 3;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      Vec2d const p{8.0 * column, 16.0 * row};
      field.position_px.push_back(p);
      field.displacement_px.push_back({3e-3 * p.x, 4e-3 * p.x + 5e-3 * p.y});
    }
  }
  for (double const gradient : local_gradient(field)) EXPECT_NEAR(gradient, std::sqrt(45e-6), 1e-15);
}

// A ramp from 1.2 to 1.6 kg/m^3 with a uniform sigma: the largest deviation from 1.2 is at the right end.
TEST_F(Figures, OfADensityProfileNameItsLargestDeviation) {
  Reconstruction ramp;
  ramp.grid = {5, 3, {-2e-3, -1e-3}, {1e-3, 1e-3}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 5; ++column) ramp.density.push_back(1.2 + 0.1 * column);
  ramp.sigma.assign(15, 0.01);
  ramp.reference_density = 1.2;
  EXPECT_EQ(describe_density_profile(ramp),
            "Density with its standard uncertainty at y = -1 mm, through the largest deviation from the reference of "
            "1.2 kg/m^3: 1.6 +- 0.01 kg/m^3 at x = 2 mm.");
  draw_figure(make_density_profile(ramp), in_folder("profile.png"));
  EXPECT_TRUE(std::filesystem::exists(in_folder("profile.png")));
  ramp.sigma.assign(15, std::numeric_limits<double>::quiet_NaN());
  ramp.density.assign(15, std::numeric_limits<double>::quiet_NaN());
  draw_figure(make_density_profile(ramp), in_folder("empty.png"));
}

}  // namespace
}  // namespace gladstone
