#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

/// A spherical Gaussian blob, rho = 1.2 + 0.5 exp(-r^2/a^2) kg/m^3 with a = 2 mm, in a view of 12.3 mm: the ambient
/// density at all sides. At f/32 the cone of 0.82 mm in the medium lowers the peak of the projection by 2 %.
constexpr char const* blob_setup = R"(schema = 1
experiment = "bos"

[camera]
pixels = [192, 192]
pixel_pitch_um = 10.0

[lens]
focal_length_mm = 105.0
f_number = 32.0

[geometry]
z_a_mm = 750.0
z_d_mm = 250.0

[medium]
ambient_density_kg_m3 = 1.2
thickness_mm = 14.0

[medium.field]
kind = "gaussian_blob"
amplitude_kg_m3 = 0.5
radius_mm = 2.0

[target]
dots_per_32px_window = 25.0

[render]
method = "rays"
rays_per_dot = 64

[correlate]
window_px = [32, 16]
overlap = 0.5
)";

class ReconstructedDensity : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    write("setup.toml", blob_setup);
  }
  /// Renders and correlates the case.
  void measure(std::vector<std::string> const& more = {}) const {
    render("case", more);
    succeed({"correlate", "case", "--set", "correlate.uncertainty=correlation_statistics"});
  }
  /// Writes the vectors of the case as x,y,u,v of an unnamed program.
  void write_foreign(std::string const& name, bool valid = true) const {
    write_foreign_where(name, [valid](double) { return valid; });
  }
  /// Writes them with NaN where `valid` is false for the column in px.
  void write_foreign_where(std::string const& name, std::function<bool(double)> const& valid) const {
    Hdf5Reader const file(in("case/vectors.h5").string());
    auto const x = file.read("x_px"), y = file.read("y_px"), u = file.read("u_px"), v = file.read("v_px");
    std::string text = "x,y,u,v\n";
    for (std::size_t i = 0; i < x.size(); ++i)
      text += valid(x[i]) ? fmt::format("{},{},{},{}\n", x[i], y[i], u[i], v[i])
                          : fmt::format("{},{},nan,nan\n", x[i], y[i]);
    write(name, text);
  }
  nlohmann::json reconstruct(std::vector<std::string> const& more, std::string const& place = "case") const {
    std::vector<std::string> arguments{"reconstruct", place, "-o", "density.h5", "--no-figures"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return json_of(arguments);
  }
};

// The mean density over L = 14 mm is 1.2 + A a sqrt(pi)/L exp(-(x^2 + y^2)/a^2), 1.3266 kg/m^3 at the centre. Windows
// of 16 px (1.0 mm) and the cone lower the peak by at most (1.0^2/12 + 0.82^2/16) 2/a^2 = 6 % of the excess.
TEST_F(ReconstructedDensity, IsTheMeanDensityOfABlob) {
  measure();
  auto const result = json_of({"reconstruct", "case", "-o", "density.h5", "--reference", "left", "--reference", "top"});
  Hdf5Reader const file(in("density.h5").string());
  auto const x = file.read("/x_mm"), y = file.read("/y_mm"), truth = file.read("/truth_kg_m3"),
             density = file.read("/density_kg_m3");
  ASSERT_EQ(file.shape("/density_kg_m3"), (std::vector<std::size_t>{y.size(), x.size()}));
  EXPECT_GT(x.back(), 4.0);
  EXPECT_GT(y.back(), y.front()) << "rows upwards";
  double const excess = 0.5 * 2.0 * std::sqrt(std::acos(-1.0)) / 14.0;
  for (std::size_t row = 0; row < y.size(); ++row)
    for (std::size_t column = 0; column < x.size(); ++column) {
      double const expected = 1.2 + excess * std::exp(-(x[column] * x[column] + y[row] * y[row]) / 4.0);
      EXPECT_NEAR(truth[row * x.size() + column], expected, 1e-3 * excess) << x[column] << ' ' << y[row];
      EXPECT_NEAR(density[row * x.size() + column], expected, 0.15 * excess) << x[column] << ' ' << y[row];
    }
  auto const& error = result["error_kg_m3"];
  EXPECT_EQ(error["count"], density.size());
  EXPECT_LT(error["rms"].get<double>(), 0.04 * excess);
  EXPECT_NEAR(result["density_kg_m3"]["largest"].get<double>(), 1.2 + 0.94 * excess, 0.04 * excess);
  EXPECT_GT(result["sigma_kg_m3"]["median"].get<double>(), 0.0);
  EXPECT_TRUE(std::filesystem::exists(in("density.png")));
  EXPECT_THAT(warnings_in(result), testing::Not(testing::Contains("unsuitable at reference")));
  auto const inside = reconstruct({"--reference", "1,-1,2,1"});
  EXPECT_THAT(warnings_in(inside), testing::Contains("unsuitable at reference")) << "the gradient is largest there";
}

// Poisson integration without weights and the least squares differ only by their treatment of noise.
TEST_F(ReconstructedDensity, HasTheChosenGaugeMethodAndUncertainty) {
  measure();
  auto const wls = reconstruct({"--reference", "right:2"});
  auto const shifted =
      reconstruct({"--reference", "5,-6,7,6", "--reference-density", "2.2", "--reference-sigma", "0.1"});
  EXPECT_NEAR(shifted["density_kg_m3"]["largest"].get<double>(), wls["density_kg_m3"]["largest"].get<double>() + 1.0,
              5e-3);
  EXPECT_NEAR(shifted["sigma_kg_m3"]["least"].get<double>(), 0.1, 1e-12) << "at the reference";
  auto const poisson = reconstruct({"--reference", "right:2", "--method", "poisson", "--scale-uncertainty", "0.5"});
  double const excess = poisson["density_kg_m3"]["largest"].get<double>() - 1.2;
  EXPECT_NEAR(excess, wls["density_kg_m3"]["largest"].get<double>() - 1.2, 0.05 * excess);
  EXPECT_NEAR(poisson["sigma_kg_m3"]["largest"].get<double>(), 0.5 * excess, 0.02 * excess);
  EXPECT_LT(poisson["sigma_random_kg_m3"]["largest"].get<double>(), 0.2 * excess);
}

// Reconstruction is linear: the causes add up to the error, in the plane and for a radial density. The table of
// quantities contains them.
TEST_F(ReconstructedDensity, HasAnErrorBudgetThatAddsUp) {
  measure();
  for (std::vector<std::string> const& how :
       {std::vector<std::string>{"--reference", "left", "--budget"}, {"--axisymmetric", "--axis", "x=0", "--budget"}}) {
    auto const result = reconstruct(how);
    auto const& budget = result["budget_kg_m3"];
    for (char const* term : {"integration", "small_angle", "cone", "refraction", "window", "estimator", "total"})
      ASSERT_TRUE(budget.contains(term)) << term;
    double sum = 0.0;
    for (auto const& [name, term] : budget.items())
      if (name != "total") sum += term["bias"].get<double>();
    EXPECT_NEAR(sum, budget["total"]["bias"].get<double>(), 1e-9);
    EXPECT_NEAR(budget["total"]["rms"].get<double>(), result["error_kg_m3"]["rms"].get<double>(),
                0.1 * result["error_kg_m3"]["rms"].get<double>());
    EXPECT_LT(budget["small_angle"]["rms"].get<double>(), budget["cone"]["rms"].get<double>());
    std::vector<std::string> csv{"reconstruct", "case", "-o", "density.h5", "--no-figures", "--csv"};
    csv.insert(csv.end(), how.begin(), how.end());
    EXPECT_THAT(succeed(csv), testing::HasSubstr(fmt::format("\nbudget_kg_m3.total.rms,,rms,{:.17g},kg/m^3,\n",
                                                             budget["total"]["rms"].get<double>())));
  }
}

// In the plane through the axis the density is 1.2 + A exp(-r^2/a^2), whichever diameter is taken for the axis.
TEST_F(ReconstructedDensity, OfAnAxisymmetricFlowIsItsCrossSection) {
  measure();
  for (std::string const direction : {"vertical", "horizontal"}) {
    auto const result = reconstruct({"--axisymmetric", "--axis", direction});
    EXPECT_NEAR(result["axis"]["position_mm"].get<double>(), 0.0, 0.05) << direction;
    EXPECT_LT(result["axis"]["asymmetry"].get<double>(), 0.1);
    EXPECT_NEAR(result["density_kg_m3"]["largest"].get<double>(), 1.7, 0.06) << direction;
    EXPECT_LT(result["error_kg_m3"]["rms"].get<double>(), 0.02) << direction;
  }
  auto const given = reconstruct({"--axisymmetric", "--axis", "x=0", "--abel", "tikhonov"});
  EXPECT_GT(given["axis"]["lambda"].get<double>(), 0.0);
  EXPECT_TRUE(given["axis"]["sigma_mm"].is_null()) << "given";
  EXPECT_LT(given["error_kg_m3"]["rms"].get<double>(), 0.02);
  Hdf5Reader const file(in("density.h5").string());
  EXPECT_EQ(file.attribute("axis_direction"), "vertical");
}

// At f/11 the cone of 2.4 mm takes (2.4^2/16) 2/a^2 = 18 % off the peak, most of which the deconvolution restores. The
// uncertainty does not contain these 0.02 kg/m^3, as a warning says. At f/200 the cone of 0.13 mm takes 0.05 % off.
TEST_F(ReconstructedDensity, IsDeconvolvedFromTheAperture) {
  measure({"--set", "lens.f_number=11"});
  auto const averaged = reconstruct({"--reference", "left"});
  auto const sharp = reconstruct({"--reference", "left", "--deconvolve", "3", "--samples", "50"});
  EXPECT_LT(sharp["error_kg_m3"]["rms"].get<double>(), 0.6 * averaged["error_kg_m3"]["rms"].get<double>());
  EXPECT_GT(sharp["white_noise_gain"].get<double>(), 1.0);
  EXPECT_GT(sharp["sigma_random_kg_m3"]["median"].get<double>(),
            averaged["sigma_random_kg_m3"]["median"].get<double>());
  auto const mentions_cone = testing::Contains("low_accuracy at lens.f_number");
  EXPECT_THAT(warnings_in(averaged), mentions_cone);
  EXPECT_THAT(warnings_in(sharp), testing::Not(mentions_cone));
  measure({"--set", "lens.f_number=200"});
  EXPECT_THAT(warnings_in(reconstruct({"--reference", "left"})), testing::Not(mentions_cone));
}

// Measured images have a setup and vectors, but no truth: the density is that of the case.
TEST_F(ReconstructedDensity, OfMeasuredImagesNeedsTheirSetupAndVectors) {
  render("case");
  succeed({"correlate", "case", "--set", "correlate.uncertainty=none"});  // as v.csv
  write_foreign("v.csv");
  std::string const field = "[medium.field]\nkind = \"gaussian_blob\"\namplitude_kg_m3 = 0.5\nradius_mm = 2.0\n";
  write("experiment.toml", with(blob_setup, field, ""));
  reconstruct({"--reference", "left"});
  auto const ours = Hdf5Reader(in("density.h5").string()).read("/density_kg_m3");
  auto const result = reconstruct({"--reference", "left", "--vectors", "v.csv"}, "experiment.toml");
  Hdf5Reader const file(in("density.h5").string());
  auto const theirs = file.read("/density_kg_m3");
  ASSERT_EQ(theirs.size(), ours.size());
  for (std::size_t i = 0; i < ours.size(); ++i) EXPECT_NEAR(theirs[i], ours[i], 1e-9);
  EXPECT_FALSE(file.has("/truth_kg_m3"));
  EXPECT_FALSE(result.contains("error_kg_m3"));
  EXPECT_TRUE(result["sigma_kg_m3"]["median"].is_null()) << "vectors without uncertainty";
  EXPECT_THAT(warnings_in(result), testing::Contains("incomplete at correlate.uncertainty"));
  EXPECT_EQ(file.attribute("vectors_sha256").size(), 64u);

  // without the thickness a warning names the assumed one
  write("experiment.toml", with(with(blob_setup, field, ""), "thickness_mm = 14.0\n", ""));
  auto const assumed = reconstruct({"--reference", "left", "--vectors", "v.csv"}, "experiment.toml");
  EXPECT_THAT(warnings_in(assumed), testing::Contains("assumed at medium.thickness_mm"));
}

// A masked reference region does not determine the density. If a mask divides the vectors, the part without a reference
// region has no density; a second reference region in this part determines it.
TEST_F(ReconstructedDensity, ReportsAGaugeThatMasksCover) {
  render("case");
  succeed({"correlate", "case"});
  write_foreign_where("covered.csv", [](double x) { return x > 40; });
  expect_error({"reconstruct", "case", "--vectors", "covered.csv", "--reference", "left", "-o", "density.h5"}, 2,
               "undetermined at reference");
  EXPECT_FALSE(std::filesystem::exists(in("density.h5")));
  reconstruct({"--vectors", "covered.csv", "--reference", "right"});

  write_foreign_where("divided.csv", [](double x) { return std::abs(x - 96) > 12; });
  auto const determined = [&](std::vector<double>& density) {
    density = Hdf5Reader(in("density.h5").string()).read("/density_kg_m3");
    return std::count_if(density.begin(), density.end(), [](double value) { return std::isfinite(value); });
  };
  std::vector<double> density;
  auto const half = reconstruct({"--vectors", "divided.csv", "--reference", "left"});
  EXPECT_THAT(warnings_in(half), testing::Contains("incomplete at reference"));
  auto const left_nodes = determined(density);
  EXPECT_EQ(half["determined"], left_nodes);
  std::size_t const columns = half["columns"];
  EXPECT_TRUE(std::isfinite(density[0]));
  EXPECT_TRUE(std::isnan(density[columns - 1]));
  auto const whole = reconstruct({"--vectors", "divided.csv", "--reference", "left", "--reference", "right"});
  EXPECT_THAT(warnings_in(whole), testing::Not(testing::Contains("incomplete at reference")));
  EXPECT_GT(determined(density), left_nodes);
  EXPECT_TRUE(std::isfinite(density[columns - 1]));
}

// Half of the image, or an image with a masked border, determines the density of an axisymmetric flow as well as the
// complete image. If the axis is in the masked half, its position must be given.
TEST_F(ReconstructedDensity, OfAPartOfAnAxisymmetricFlow) {
  measure();
  auto const error = [&](std::string const& vectors, std::string const& axis) {
    auto const result = reconstruct({"--vectors", vectors, "--axisymmetric", "--axis", axis});
    EXPECT_GT(result["density_kg_m3"]["largest"].get<double>(), 1.6) << vectors;
    return result["error_kg_m3"]["rms"].get<double>();
  };
  write_foreign_where("right.csv", [](double x) { return x > 95; });
  write_foreign_where("inner.csv", [](double x) { return x > 20 && x < 172; });
  EXPECT_LT(error("right.csv", "x=0"), 0.03);
  EXPECT_LT(error("inner.csv", "vertical"), 0.02);
  expect_error({"reconstruct", "case", "--vectors", "right.csv", "--axisymmetric", "-o", "d.h5"}, 2,
               "inconsistent at axis");
}

TEST_F(ReconstructedDensity, RefusesWhatDeterminesNoDensity) {
  render("case");
  succeed({"correlate", "case"});
  auto const refused = [&](std::vector<std::string> const& more, int exit_code, std::string const& error,
                           std::vector<std::string> const& values = {}) {
    std::vector<std::string> arguments{"reconstruct", "case", "-o", "density.h5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_error(arguments, exit_code, error, values);
  };
  refused({}, 2, "arguments at --reference", {"left"});
  refused({"--reference", "middle"}, 2, "invalid_value at --reference", {"middle"});
  refused({"--reference", "left:0"}, 2, "invalid_value at --reference", {"left:0"});
  refused({"--reference", "1,2,3"}, 2, "invalid_value at --reference", {"1,2,3"});
  refused({"--reference", "90,90,99,99"}, 2, "invalid_value at reference", {"90 to 99 mm"});
  refused({"--reference", "left", "--axisymmetric"}, 2, "arguments at --reference", {"--axisymmetric"});
  refused({"--reference", "left", "--axis", "x=0"}, 2, "arguments at --axis", {"--axisymmetric"});
  refused({"--axisymmetric", "--axis", "z=0"}, 2, "invalid_value at --axis", {"z=0"});
  refused({"--axisymmetric", "--axis", "x=70"}, 2, "invalid_value at axis", {"70 mm"});
  refused({"--axisymmetric", "--axis", "x=3"}, 2, "inconsistent at axis", {"3 mm"});
  refused({"--axisymmetric", "--abel", "tikhonov", "--lambda", "-1"}, 2, "invalid_value at lambda", {"-1"});
  refused({"--reference", "left", "--overlap", "1"}, 2, "invalid_value at --overlap");
  refused({"--reference", "left", "--deconvolve", "0.5"}, 2, "invalid_value at --deconvolve", {"0.5"});
  refused({"--reference", "left", "--vectors", "absent.h5"}, 2, "missing_file at absent.h5");
  expect_error({"reconstruct", "setup.toml", "--reference", "left", "-o", "density.h5"}, 2,
               "wrong_format at setup.toml", {"--vectors"});
  succeed({"correlate", "case", "-o", "v.csv"});
  expect_error({"reconstruct", "setup.toml", "--vectors", "v.csv", "--reference", "left", "--budget", "-o", "d.h5"}, 2,
               "missing_file at setup.toml", {"--budget"});
  expect_error({"reconstruct", "case", "--reference", "left", "-o", "density.txt"}, 2, "output at density.txt",
               {".h5"});
  expect_error({"reconstruct", "case", "--reference", "left", "-o", "case/truth.h5"}, 2,
               "overwrites_input at truth.h5");

  write_foreign("none.csv", false);
  refused({"--reference", "left", "--vectors", "none.csv"}, 1, "no_valid_vector at none.csv");
  expect_error({"reconstruct", "setup.toml", "--reference", "left", "--vectors", "none.csv", "-o", "d.h5"}, 1,
               "no_valid_vector at none.csv");
}

}  // namespace
}  // namespace gladstone::end_to_end
