#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

/// A Gaussian blob with a radius of 3 mm in a view of 15.3 mm, 0.16 mm per px in the flow.
constexpr char const* views_of_blob = R"(
[camera]
pixels = [96, 96]
pixel_pitch_um = 25.0
[lens]
focal_length_mm = 105.0
f_number = 32.0
[geometry]
z_a_mm = 750.0
z_d_mm = 250.0
[medium.field]
kind = "gaussian_blob"
amplitude_kg_m3 = -0.5
radius_mm = 3.0
[target]
dots_per_32px_window = 30.0
[render]
rays_per_dot = 16
[correlate]
window_px = [24, 12]
)";

/// Three rendered and correlated views of the blob.
class Tomography : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    write("blob.toml", views_of_blob);
    succeed({"tomography", "blob.toml", "--views", "3", "-o", "views", "--quiet"});
    for (char const* view : {"0", "1", "2"}) {
      succeed({"render", std::string("views/view_0") + view + ".toml", "-o", view, "--quiet"});
      succeed({"correlate", view, "--quiet"});
    }
  }
  static std::vector<std::string> words(std::vector<std::string> const& more) {
    std::vector<std::string> arguments{"tomography", "0", "1", "2", "-o", "volume.h5", "--no-figures", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  nlohmann::json reconstruct(std::vector<std::string> const& more) const { return json_of(words(more)); }
  /// Writes the vectors of a case, times a factor, as CSV, with NaN where `valid` is false for the column in px.
  void write_vectors(std::string const& name, std::string const& view, std::function<bool(double)> const& valid,
                     double factor = 1.0) const {
    Hdf5Reader const file(in(view + "/vectors.h5").string());
    auto const x = file.read("x_px"), y = file.read("y_px"), u = file.read("u_px"), v = file.read("v_px");
    std::string text = "x,y,u,v\n";
    for (std::size_t i = 0; i < x.size(); ++i)
      text += valid(x[i]) ? fmt::format("{},{},{},{}\n", x[i], y[i], factor * u[i], factor * v[i])
                          : fmt::format("{},{},nan,nan\n", x[i], y[i]);
    write(name, text);
  }
};

// Exact line integrals of such a blob in three views have an error of 7 % (docs/how-to/tomography.md). Windows of 12 px
// (1.9 mm) and the cone of 0.8 mm remove (w^2/12 + c^2/16) (2/a^2) = 8 % of its peak, and the rays another few percent.
// The displacement of rays has neither windows nor noise of the dots.
TEST_F(Tomography, OfRenderedViewsIsTheKnownVolume) {
  auto const measured = reconstruct({"--reference", "left"});
  EXPECT_LT(measured["relative_error"].get<double>(), 0.18);
  auto const rays = reconstruct({"--reference", "left", "--ray-truth"});
  EXPECT_LT(rays["relative_error"].get<double>(), 0.12);
  Hdf5Reader const file(in("volume.h5").string());
  auto const truth = file.read("/truth_kg_m3"), density = file.read("/density_kg_m3");
  ASSERT_EQ(truth.size(), density.size());
  EXPECT_EQ(file.shape("/density_kg_m3").size(), 3u);
}

// A support that contradicts the views leaves a residual, which is warned of; so are vectors that a mask
// separates from the reference.
TEST_F(Tomography, WarnsOfWhatTheVolumeDoesNotExplain) {
  auto const narrow = reconstruct({"--reference", "left", "--support", "cylinder:0.01"});
  EXPECT_THAT(warnings_in(narrow), testing::Contains("unreliable"));
  auto const whole = [](double) { return true; };
  write_vectors("0.csv", "0", [](double x) { return std::abs(x - 47.5) > 4; });
  write_vectors("1.csv", "1", whole);
  write_vectors("2.csv", "2", whole);
  std::vector<std::string> const given{"--vectors", "0.csv", "1.csv", "2.csv", "--reference", "left"};
  auto const divided = warnings_in(reconstruct(given));
  EXPECT_THAT(divided, testing::Contains("excluded at 0"));
  EXPECT_THAT(divided, testing::Not(testing::Contains("excluded at 1")));
  std::vector<std::string> both = given;
  both.insert(both.end(), {"--reference", "right"});
  EXPECT_THAT(warnings_in(reconstruct(both)), testing::Not(testing::Contains("excluded at 0")));
}

// One view has the vectors of the others' flow with the opposite sign, as if its frames were exchanged. With only three
// views, the warning may name two of them.
TEST_F(Tomography, WarnsOfAViewThatContradictsTheOthers) {
  auto const right = reconstruct({"--reference", "left"});
  EXPECT_THAT(warnings_in(right), testing::Not(testing::Contains(testing::StartsWith("unreliable at "))));
  EXPECT_EQ(right["view_residual"].size(), 3u);
  EXPECT_THAT(succeed(words({"--reference", "left", "--csv"})),
              testing::HasSubstr(fmt::format("\nview_residual.2,,residual of 2,{:.17g},,\n",
                                             right["view_residual"][2].get<double>())));
  auto const whole = [](double) { return true; };
  write_vectors("0.csv", "0", whole);
  write_vectors("1.csv", "1", whole, -1.0);
  write_vectors("2.csv", "2", whole);
  auto const wrong = reconstruct({"--vectors", "0.csv", "1.csv", "2.csv", "--reference", "left"});
  EXPECT_THAT(warnings_in(wrong), testing::Contains("unreliable at 1"));
  EXPECT_THAT(warnings_in(wrong), testing::Not(testing::Contains("unreliable at 2")));
  EXPECT_EQ(Hdf5Reader(in("volume.h5").string()).read("/view_residual").at(1), wrong["view_residual"][1].get<double>());
}

TEST_F(Tomography, RefusesWhatDeterminesNoVolume) {
  auto const refused = [&](std::vector<std::string> const& more, std::string const& error,
                           std::vector<std::string> const& values = {}) {
    expect_error(words(more), 2, error, values);
  };
  refused({}, "arguments at --reference");
  refused({"--reference", "left", "--angles", "0,60"}, "arguments at --angles", {"3 views"});
  refused({"--reference", "left", "--bounds", "100,100,100,110,110,110"}, "undetermined at tomography",
          {"0 views", "--bounds"});
  refused({"--reference", "left", "--spacing", "50"}, "invalid_value at --spacing", {"50 mm"});
  refused({"--reference", "90,90,99,99"}, "invalid_value at reference", {"90 to 99 mm"});
  expect_error({"tomography", "0", "1", "--reference", "left", "-o", "volume.h5"}, 2, "arguments at views",
               {"3 to 16", " 2"});
  expect_error({"tomography", "0", "1", "1", "--reference", "left", "-o", "volume.h5"}, 2, "arguments at views");
  write_vectors("0.csv", "0", [](double x) { return x > 20; });
  expect_error(
      {"tomography", "0", "1", "2", "--vectors", "0.csv", "0.csv", "0.csv", "--reference", "left", "-o", "volume.h5"},
      2, "undetermined at 0.csv");
  std::filesystem::remove(in("2/vectors.h5"));
  refused({"--reference", "left"}, "missing_file at vectors.h5", {"gladstone correlate 2"});
  EXPECT_FALSE(std::filesystem::exists(in("volume.h5")));
}

}  // namespace
}  // namespace gladstone::end_to_end
