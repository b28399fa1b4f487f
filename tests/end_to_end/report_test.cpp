#include <algorithm>
#include <cmath>
#include <sstream>

#include "tests/end_to_end/support/workplace.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

class Reports : public Workplace {
 protected:
  /// Six cases of a few milliseconds each.
  void finish_study() const {
    write("study.toml",
          "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 16, 32]\n\"render.rays_per_dot\" = [16, 32]\n");
    succeed({"sweep", "plan", "study.toml", "-o", "run", "--quiet", "--device", "cpu"});
    succeed({"sweep", "run", "run", "--quiet", "--keep-images"});
    succeed({"sweep", "collect", "run", "--no-figures", "--quiet"});
  }
  nlohmann::json data_of(std::string const& report) const {
    std::string const html = read(report), head = "id=\"data\">";
    auto const begin = html.find(head) + head.size();
    return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
  }
};

TEST_F(Reports, OfAStudyHoldsItsNumbersAndPictures) {
  finish_study();
  nlohmann::json const result = json_of({"report", "run", "--quiet"});
  EXPECT_EQ(result["report"], "run/report.html");
  EXPECT_THAT(result["findings"].get<std::string>(), HasSubstr("The largest cause of error is "));
  std::string const html = read("run/report.html");
  EXPECT_THAT(html, HasSubstr("How wrong is the measured displacement against Eq. 9"));
  EXPECT_THAT(html, HasSubstr("6 of 6 cases are finished"));
  EXPECT_THAT(html,
              HasSubstr(", the best</figcaption>\n<img alt=\"Seen from the side, to scale: the dots stand Z_D = "));
  EXPECT_THAT(html, HasSubstr("data:image/png;base64,iVBOR"));
  nlohmann::json const data = data_of("run/report.html");
  ASSERT_EQ(data["rows"].size(), 6u);
  Hdf5Reader const table(in("run/study.h5").string());
  for (std::size_t m = 0; m < data["measures"].size(); ++m) {
    auto const column = table.read(data["measures"][m]["name"].get<std::string>());
    for (std::size_t i = 0; i < 6; ++i) {
      nlohmann::json const& value = data["rows"][i]["m"][m];
      if (value.is_null()) continue;
      EXPECT_EQ(value.get<double>(), column[i]) << data["measures"][m]["name"];
    }
  }
}

TEST_F(Reports, OfACaseAddUpTheirCauses) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  succeed({"report", "case", "--quiet"});
  nlohmann::json const data = data_of("case/report.html");
  auto const field = [&](std::string const& name) -> nlohmann::json const& {
    for (nlohmann::json const& one : data["fields"]) {
      if (one["name"] == name) return one["u"];
    }
    ADD_FAILURE() << name;
    return data;
  };
  std::size_t told = 0;
  for (std::size_t i = 0; i < field("error_truth").size(); ++i) {
    if (field("error_truth")[i].is_null()) continue;
    double sum = 0;
    for (char const* cause : {"window", "estimator", "noise"}) sum += field(cause)[i].get<double>();
    EXPECT_NEAR(sum, field("error_truth")[i].get<double>(), 2e-6);  // four numbers rounded to 1e-6 px
    ++told;
  }
  EXPECT_GT(told, 0u);
  std::string const html = read("case/report.html");
  EXPECT_THAT(html, HasSubstr("expanded uncertainty"));
  EXPECT_THAT(html, HasSubstr("Layout of the case"));
  EXPECT_THAT(html, HasSubstr("<img alt=\"Seen from the side, to scale: the dots stand Z_D = "));
  EXPECT_THAT(html, HasSubstr("Design map of the case"));
}

// Frames and vectors that somebody measured, with a setup that describes the bench and no truth: what is told rests on
// the vectors. A uniform gradient of 40 kg/m^4 integrates to a ramp, which the twin displaces by as much again.
TEST_F(Reports, OfAMeasurementTellItsUncertaintyFromATwin) {
  std::string const setup = R"(schema = 1
[camera]
pixels = [128, 128]
bit_depth = 12
[camera.noise]
full_well_e = 30000
[geometry]
z_a_mm = 750.0
z_d_mm = { value = 250.0, sigma = 2.5 }
[medium.field]
kind = "uniform_gradient"
gradient_kg_m4 = [40.0, 0.0, 0.0]
[correlate]
window_px = [32, 16]
)";
  write("bench.toml", setup);
  render("case", {}, "bench.toml");
  std::filesystem::create_directories(in("measured"));
  for (char const* const name : {"reference.tif", "flow.tif"}) {
    std::filesystem::copy_file(in(std::string("case/") + name), in(std::string("measured/") + name));
  }
  std::string without_field = setup;
  without_field.erase(without_field.find("[medium.field]"), setup.find("[correlate]") - setup.find("[medium.field]"));
  write("measured/setup.toml", without_field);
  succeed({"correlate", "measured/reference.tif", "measured/flow.tif", "-o", "measured/vectors.h5", "--config",
           "measured/setup.toml", "--quiet"});
  std::string const findings = json_of({"report", "measured", "--device", "cpu"})["findings"];
  EXPECT_THAT(findings, HasSubstr("combined standard uncertainty"));
  EXPECT_THAT(findings, HasSubstr("coverage factor k = 2.00"));
  EXPECT_THAT(findings, HasSubstr("In the simulated twin"));
  std::string const html = read("measured/report.html");
  EXPECT_THAT(html, HasSubstr("of the simulated twin and not of the measurement itself"));
  EXPECT_THAT(html, HasSubstr("geometry.z_d_mm"));
  EXPECT_THAT(html, HasSubstr("the dots stand Z_D = 250 mm behind the medium"));
  EXPECT_THAT(html, HasSubstr("of type B: by the formula of the random error (F26), since the vectors have none"));
  succeed({"report", "measured", "--format", "md", "-o", "text/m.md", "--figures", "paper", "--figure-format", "svg",
           "--quiet"});
  EXPECT_THAT(read("text/m.md"), HasSubstr("measured_maps.svg"));
  for (char const* const figure : {"measured_maps", "layout", "design_map"}) {
    EXPECT_THAT(read(std::string("paper/") + figure + ".svg"), HasSubstr("</svg>")) << figure;
  }
  nlohmann::json const data = data_of("measured/report.html");
  auto const mean_of = [&](std::string const& name, char const* component) {
    for (nlohmann::json const& one : data["fields"]) {
      if (one["name"] != name) continue;
      double sum = 0;
      for (nlohmann::json const& value : one[component]) sum += value.is_null() ? 0 : value.get<double>();
      return sum / static_cast<double>(one[component].size());
    }
    return std::nan("");
  };
  // in one px there are 150.9 kg/m^4; the bias of a vector, 0.002 px, is 0.3
  EXPECT_NEAR(mean_of("gradient", "u"), 40, 0.5);
  EXPECT_NEAR(mean_of("gradient", "v"), 0, 0.5);
  // Z_D alone: (1 - Z_D / (Z_B - f)) 1 % of 40 kg/m^4, and the displacement's part on top
  double const common = (1 - 250.0 / 895) * 0.01 * 40;
  EXPECT_GT(mean_of("combined", "u"), common);
  EXPECT_NEAR(mean_of("combined", "u"), std::hypot(common, mean_of("random", "u")), 0.1 * common);
  write("still.csv", "x,y,u,v\n10,10,0,0\n30,10,0,0\n10,30,0,0\n30,30,0,0\n");
  succeed({"report", "measured", "--vectors", "still.csv", "--format", "md", "-o", "text/still.md", "--quiet"});
  EXPECT_THAT(read("text/still.md"), testing::Not(HasSubstr("nan")));
  EXPECT_THAT(read("text/still.md"),
              HasSubstr("by the formula of the random error (F26), since the vectors have none"));
  expect_refused({"report", "measured", "--vectors", "nothing.csv"}, 2, {"nothing.csv"});
}

/// The displacements along x of a file of vectors.
std::vector<double> displacements_of(std::string const& csv) {
  std::istringstream lines(csv);
  std::vector<double> u;
  std::size_t column = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::vector<std::string> cells;
    std::istringstream parts(line);
    for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
    auto const head = std::find(cells.begin(), cells.end(), "u_px");
    if (head != cells.end()) {
      column = static_cast<std::size_t>(head - cells.begin());
    } else {
      u.push_back(std::stod(cells.at(column)));
    }
  }
  return u;
}

// The same steady field measured twice, with other noise: the standard deviation of a mean of two is half of what they
// differ by, and has one degree of freedom (JCGM 100:2008, 4.2). In one px there are 150.9 kg/m^4.
TEST_F(Reports, OfARepeatedMeasurementTellItsScatter) {
  std::string const setup = R"(schema = 1
[camera]
pixels = [128, 128]
bit_depth = 12
[camera.noise]
full_well_e = 30000
read_noise_e = 300
[geometry]
z_a_mm = 750.0
z_d_mm = 250.0
[medium.field]
kind = "uniform_gradient"
gradient_kg_m4 = [40.0, 0.0, 0.0]
[correlate]
window_px = [32, 16]
)";
  write("bench.toml", setup);
  std::filesystem::create_directories(in("measured"));
  write("measured/setup.toml", setup);
  std::vector<std::vector<double>> u;
  for (std::string const repeat : {"1", "2"}) {
    render("case" + repeat, {"--set", "camera.noise.seed=" + repeat}, "bench.toml");
    succeed({"correlate", "case" + repeat, "-o", "measured/" + repeat + ".csv", "--quiet"});
    u.push_back(displacements_of(read("measured/" + repeat + ".csv")));
  }
  ASSERT_EQ(u[0].size(), u[1].size());
  double scatter = 0;
  for (std::size_t i = 0; i < u[0].size(); ++i) scatter += std::abs(u[0][i] - u[1][i]) / 2;
  scatter /= static_cast<double>(u[0].size());
  ASSERT_GT(scatter, 1e-4);
  std::string const findings = json_of({"report", "measured", "--vectors", "measured/1.csv", "--repeats",
                                        "measured/2.csv", "--device", "cpu"})["findings"];
  EXPECT_THAT(findings, HasSubstr("effective degrees of freedom 1)"));
  EXPECT_THAT(findings, HasSubstr("coverage factor k = 13.97"));
  EXPECT_THAT(read("measured/report.html"), HasSubstr("is of type A: the standard deviation of the mean of 2 repeats"));
  nlohmann::json const data = data_of("measured/report.html");
  for (nlohmann::json const& one : data["fields"]) {
    if (one["name"] != "random") continue;
    double mean = 0;
    for (nlohmann::json const& value : one["u"]) mean += value.get<double>() / static_cast<double>(one["u"].size());
    EXPECT_NEAR(mean, scatter * 150.9, 0.01 * scatter * 150.9);
  }
  write("measured/other.csv", "x_px,y_px,u_px,v_px\n10,10,0.1,0\n20,10,0.1,0\n");
  expect_refused({"report", "measured", "--vectors", "measured/1.csv", "--repeats", "measured/other.csv"}, 2,
                 {"other.csv", "at other places"});
  expect_refused({"report", "case1", "--repeats", "measured/2.csv"}, 2, {"is no measurement"});
}

TEST_F(Reports, AreWrittenAsMarkdownWithFiguresBesideIt) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  succeed({"report", "case", "--format", "md", "-o", "text/report.md", "--figure-format", "svg", "--quiet"});
  EXPECT_THAT(read("text/report.md"), HasSubstr("![error\\_budget](<report_figures/error_budget.svg>)"));
  EXPECT_THAT(read("text/report_figures/error_budget.svg"), HasSubstr("</svg>"));
}

TEST_F(Reports, DrawFiguresAsPdf) {
  finish_study();
  succeed({"report", "run", "--figures", "paper", "--figure-format", "pdf", "--quiet"});
  EXPECT_TRUE(read("paper/budget_lens_f_number.pdf").starts_with("%PDF-"));
}

TEST_F(Reports, AreGoneWhenTheirCaseIsRenderedAgain) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  succeed({"report", "case", "--quiet"});
  render("case");
  EXPECT_THAT(names("case"), testing::Not(testing::Contains("report.html")));
}

TEST_F(Reports, SayWhatIsMissing) {
  expect_refused({"report", "nowhere"}, 2, {"nowhere", "neither a study", "manifest.jsonl"});
  render("case");
  expect_refused({"report", "case", "--quiet"}, 2, {"vectors.h5", "gladstone correlate"});
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 16]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--quiet", "--device", "cpu"});
  expect_refused({"report", "run"}, 2, {"holds no finished case", "gladstone sweep run run"});
  expect_refused({"report", "case", "--format", "pdf"}, 2, {"--format"});
}

}  // namespace
}  // namespace gladstone::end_to_end
