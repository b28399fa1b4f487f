#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "render/files/source_files.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

class Reports : public ProgramFixture {
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
  /// Returns the values of a map of the chart "field".
  /// @param component  'u' or 'v'
  static nlohmann::json map_of(nlohmann::json const& data, std::string const& name, char component) {
    for (nlohmann::json const& chart : data["charts"]) {
      if (chart["chart"] != "field") continue;
      for (nlohmann::json const& one : chart["figures"]) {
        if (one["name"] != name) continue;
        for (nlohmann::json const& panel : one["figure"]["panels"])
          if (panel["title"].get<std::string>().front() == component) return panel["map"]["values"];
      }
    }
    ADD_FAILURE() << name << ' ' << component;
    return nlohmann::json::array();
  }
};

TEST_F(Reports, OfAStudyHoldsItsNumbersAndPictures) {
  finish_study();
  nlohmann::json const result = json_of({"report", "run", "--quiet"});
  EXPECT_EQ(result["report"], "run/report.html");
  EXPECT_THAT(result["findings"].get<std::string>(), HasSubstr("The largest cause of error is "));
  std::string const html = read("run/report.html");
  EXPECT_THAT(html, HasSubstr("How large is the error of the measured displacement against Eq. 9"));
  EXPECT_THAT(html, ContainsWhole("6 of 6 cases are finished"));
  // the set-up is that of the base, at its own f-number; that of the best case is shown with the case
  EXPECT_THAT(html.substr(html.find("Layout of the base</figcaption>")),
              HasSubstr("<p class=\"alt\">Side view, to scale: the dots are Z_D = 250 mm behind the mid-plane of the "
                        "medium, the lens (f = 105 mm, f/11)"));
  std::string const best = html.substr(html.find("Best and worst case"));
  EXPECT_THAT(best, HasSubstr(", the best</figcaption>"));
  EXPECT_THAT(best, HasSubstr("<p class=\"alt\">Side view, to scale: the dots are Z_D"));
  EXPECT_LT(html.find("Layout of the base"), html.find("Best and worst case"));
  EXPECT_THAT(html, HasSubstr("The base setup of all cases</summary>"));
  EXPECT_THAT(html, HasSubstr("<li>f-number: 8; 16; 32</li>"));
  for (char const* const file : {"study.toml", "base.toml", "manifest.jsonl"}) {
    EXPECT_THAT(html, HasSubstr(byte_sha256(in(std::string("run/") + file).string()))) << file;
  }
  EXPECT_THAT(html, HasSubstr("data:image/png;base64,iVBOR"));
  // one point per case, with the values of the table
  nlohmann::json const data = data_of("run/report.html");
  Hdf5Reader const table(in("run/study.h5").string());
  std::vector<double> const signal = table.read("signal_px"), error = table.read("eq9.rms_px");
  std::size_t charts = 0;
  for (nlohmann::json const& chart : data["charts"]) {
    if (chart["chart"] != "scatter") continue;
    ++charts;
    nlohmann::json const& columns = chart["figures"][0]["figure"]["panels"][0]["layers"][0]["columns"];
    ASSERT_EQ(columns[0].size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {  // figures have seven digits: rounding by at most 5e-7
      EXPECT_NEAR(columns[0][i].get<double>(), signal[i], 5e-7 * std::abs(signal[i]));
      EXPECT_NEAR(columns[1][i].get<double>(), error[i], 5e-7 * std::abs(error[i]));
    }
  }
  EXPECT_EQ(charts, 1u);
}

// The stored comparison is reused if it belongs to errors.json and the files are unchanged; the report is then
// identical to the last digit. Otherwise the comparison is repeated.
TEST_F(Reports, TakeAComparisonThatFits) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  auto const reused = [this] {
    Outcome const outcome = gladstone({"report", "case"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.err.find("reused the comparison") != std::string::npos;
  };
  EXPECT_FALSE(reused()) << "no comparison is stored yet";
  nlohmann::json const fresh = data_of("case/report.html");
  succeed({"compare", "case", "--no-figures", "--quiet"});
  EXPECT_TRUE(reused());
  EXPECT_EQ(data_of("case/report.html"), fresh);
  std::string const errors = read("case/errors.json");
  write("case/errors.json", errors + '\n');
  EXPECT_FALSE(reused()) << "errors.json was changed";
  write("case/errors.json", errors);
  EXPECT_TRUE(reused());
  succeed({"correlate", "case", "--quiet", "--set", "correlate.overlap=0.25"});
  EXPECT_FALSE(reused()) << "other vectors";
  render("case");
  EXPECT_FALSE(std::filesystem::exists(in("case/comparison.h5"))) << "the comparison belonged to the previous case";
}

TEST_F(Reports, OfACaseAddUpTheirCauses) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  succeed({"report", "case", "--quiet"});
  nlohmann::json const data = data_of("case/report.html");
  nlohmann::json const error = map_of(data, "error against ray truth", 'u');
  std::vector<nlohmann::json> causes;
  for (char const* cause : {"window", "estimator", "noise"})
    causes.push_back(map_of(data, std::string("cause: ") + cause, 'u'));
  std::size_t told = 0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    if (error[i].is_null()) continue;
    double sum = 0;
    for (nlohmann::json const& cause : causes) sum += cause[i].get<double>();
    EXPECT_NEAR(sum, error[i].get<double>(), 2e-6);  // four numbers rounded to 1e-6 px
    ++told;
  }
  EXPECT_GT(told, 0u);
  // the uncorrected bias is the rms difference between Eq. 9 and the truth on the window of deformed frames; four
  // digits of a number, three of which are printed
  double squares = 0, components = 0;
  std::map<char, double> errors;
  for (char const component : {'u', 'v'}) {
    nlohmann::json const eq9 = map_of(data, "error against Eq. 9", component);
    nlohmann::json const recorded = map_of(data, "error against truth on the window of deformed frames", component);
    for (std::size_t i = 0; i < eq9.size(); ++i) {
      if (eq9[i].is_null()) continue;
      double const error = recorded[i].get<double>();
      squares += std::pow(eq9[i].get<double>() - error, 2);
      errors[component] += error * error;
      components += 1;
    }
  }
  std::string const said = read("case/report.html"), head = "<li>The uncorrected bias is ";
  ASSERT_NE(said.find(head), std::string::npos);
  double const bias = std::stod(said.substr(said.find(head) + head.size()));
  EXPECT_NEAR(bias, std::sqrt(squares / components), 0.005 * bias + 1e-6);
  std::size_t at = said.find("The combined standard uncertainty is ");
  for (auto const& [component, head_of_it] : {std::pair{'u', "uncertainty is "}, {'v', "component u and "}}) {
    at = said.find(head_of_it, at) + std::string(head_of_it).size();
    double const rms = std::stod(said.substr(at));
    EXPECT_NEAR(rms, std::sqrt(2 * errors[component] / components), 0.005 * rms + 1e-6) << component;
  }
  EXPECT_THAT(said, HasSubstr("the rms error against truth on the window of deformed frames, "));
  EXPECT_THAT(
      said,
      HasSubstr(
          "px: the true displacement averaged over the window minus the displacement by Eq. 9, rms over the vectors"));
  for (char const* const frame : {"reference", "flow"}) {
    EXPECT_THAT(said, HasSubstr(std::string("<td>") + frame + "</td><td>pixels</td><td>" +
                                pixel_sha256(in(std::string("case/") + frame + ".tif").string())));
  }
  std::string const html = read("case/report.html");
  EXPECT_THAT(html, HasSubstr("expanded uncertainty"));
  EXPECT_THAT(html, HasSubstr("Layout of the case"));
  EXPECT_THAT(html, HasSubstr("<p class=\"alt\">Side view, to scale: the dots are Z_D = "));
  EXPECT_THAT(html, HasSubstr("Design map of the case"));
}

// Vectors of other codes usually have no uncertainty.
TEST_F(Reports, OfACaseTakeVectorsOfAnotherCode) {
  render("case");
  succeed({"correlate", "case", "-o", "ours.csv", "--quiet"});
  std::istringstream ours(read("ours.csv"));
  std::string line, theirs = "x y u v\n";
  std::getline(ours, line);
  while (std::getline(ours, line)) {
    std::istringstream values(line);
    std::string value;
    for (int k = 0; k < 4 && std::getline(values, value, ','); ++k) theirs += value + (k < 3 ? ' ' : '\n');
  }
  write("theirs.txt", theirs);
  succeed({"report", "case", "--vectors", "theirs.txt", "-o", "theirs.html", "--quiet"});
  EXPECT_THAT(read("theirs.html"), HasSubstr("The combined standard uncertainty is "));
  EXPECT_THAT(read("theirs.html"), testing::Not(HasSubstr("The estimator's standard uncertainty is ")));
}

TEST_F(Reports, OfPivShowLayoutAndErrorsAgainstTheFNumber) {
  succeed({"render", GLADSTONE_DATA_DIR "/../studies/cases/piv.toml", "-o", "piv", "--set", "camera.pixels=[96, 96]",
           "--quiet"});
  succeed({"correlate", "piv", "--set", "correlate.window_px=[24]", "--quiet"});
  succeed({"report", "piv", "--figures", "drawn", "--quiet"});
  std::string const html = read("piv/report.html");
  EXPECT_THAT(html, HasSubstr("<p class=\"alt\">Side view, to scale: the laser sheet is 1 mm thick and is Z_A = "
                              "750 mm in front of the lens at f/16"));
  EXPECT_THAT(html, HasSubstr("Particle images against the f-number. At f/16"));
  EXPECT_THAT(html, HasSubstr("the rms error against truth on the window, "));  // one pass deforms nothing
  EXPECT_THAT(html, testing::Not(HasSubstr("\"estimated uncertainty")));        // no uncertainty was requested
  for (char const* const figure : {"drawn/layout.png", "drawn/design_map.png"}) {
    EXPECT_TRUE(std::filesystem::exists(in(figure))) << figure;
  }
}

// Measured frames and vectors, with a setup that describes the set-up and without truth: the report is based on the
// vectors. A uniform gradient of 40 kg/m^4 integrates to a ramp, which displaces the dots of the twin by the same
// amount.
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
[render]
method = "rays"
rays_per_dot = 256
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
  without_field.erase(without_field.find("[medium.field]"), setup.find("[render]") - setup.find("[medium.field]"));
  write("measured/setup.toml", without_field);
  succeed({"correlate", "measured/reference.tif", "measured/flow.tif", "-o", "measured/vectors.h5", "--config",
           "measured/setup.toml", "--set", "correlate.uncertainty=none", "--quiet"});
  std::string const findings = json_of({"report", "measured", "--device", "cpu"})["findings"];
  EXPECT_THAT(findings, HasSubstr("combined standard uncertainty"));
  EXPECT_THAT(findings, ContainsWhole("coverage factor k = 2.00"));
  EXPECT_THAT(findings, HasSubstr("kg/m^4, in the simulated twin"));
  EXPECT_THAT(findings, HasSubstr("medium is the measured density: the true displacement averaged over the window "
                                  "minus the displacement by Eq. 9"));
  std::string const html = read("measured/report.html");
  EXPECT_THAT(html, HasSubstr("of the simulated twin and not of the measurement itself"));
  EXPECT_THAT(html, HasSubstr("data-chart=\"budget\""));
  EXPECT_THAT(html, HasSubstr("geometry.z_d_mm"));
  EXPECT_THAT(html, HasSubstr("<td>normal</td>"));
  EXPECT_THAT(html, HasSubstr("each time with other dots (seeds "));
  for (char const* const frame : {"reference", "flow"}) {
    EXPECT_THAT(html, HasSubstr(std::string("<td>") + frame + "</td><td>pixels</td><td>" +
                                pixel_sha256(in(std::string("measured/") + frame + ".tif").string())));
  }
  EXPECT_THAT(html, HasSubstr(byte_sha256(in("measured/setup.toml").string())));
  EXPECT_THAT(html, HasSubstr(dataset_sha256(in("measured/vectors.h5").string())));
  EXPECT_THAT(html, HasSubstr("the dots are Z_D = 250 mm behind the mid-plane of the medium"));
  EXPECT_THAT(html, HasSubstr("of type B: by the formula of the random error (F26), since the vectors have none"));
  succeed({"report", "measured", "--format", "md", "-o", "text/m.md", "--figures", "paper", "--figure-format", "svg",
           "--quiet"});
  EXPECT_THAT(read("text/m.md"), HasSubstr("measured_maps.svg"));
  for (char const* const figure : {"measured_maps", "layout", "design_map"}) {
    EXPECT_THAT(read(std::string("paper/") + figure + ".svg"), HasSubstr("</svg>")) << figure;
  }
  nlohmann::json const data = data_of("measured/report.html");
  auto const mean_of = [&](std::string const& name, char component) {
    nlohmann::json const values = map_of(data, name, component);
    double sum = 0;
    for (nlohmann::json const& value : values) sum += value.is_null() ? 0 : value.get<double>();
    return sum / static_cast<double>(values.size());
  };
  std::string const gradient = "density gradient, along X and Y",
                    combined = "combined standard uncertainty of the gradient",
                    random = "contribution of the displacement to it";
  // one px is 150.9 kg/m^4; the bias of a vector, 0.002 px, is 0.3 kg/m^4
  EXPECT_NEAR(mean_of(gradient, 'u'), 40, 0.5);
  EXPECT_NEAR(mean_of(gradient, 'v'), 0, 0.5);
  // Z_D only: (1 - Z_D / (Z_B - f)) 1 % of 40 kg/m^4, plus the contribution of the displacement. The mean of the roots
  // exceeds the root with the mean contribution by at most the contribution's variance / (2 common): by less than a
  // tenth of `common` for a scatter below 0.45 common.
  double const common = (1 - 250.0 / 895) * 0.01 * 40;
  EXPECT_GT(mean_of(combined, 'u'), common);
  EXPECT_NEAR(mean_of(combined, 'u'), std::hypot(common, mean_of(random, 'u')), 0.1 * common);
  write("still.csv", "x,y,u,v\n10,10,0,0\n30,10,0,0\n10,30,0,0\n30,30,0,0\n");
  succeed({"report", "measured", "--vectors", "still.csv", "--format", "md", "-o", "text/still.md", "--quiet"});
  EXPECT_THAT(read("text/still.md"), testing::Not(HasSubstr("nan")));
  EXPECT_THAT(read("text/still.md"),
              HasSubstr("by the formula of the random error (F26), since the vectors have none"));
  EXPECT_THAT(read("text/still.md"), HasSubstr("The vectors span 2.4 % of the camera's 128 x 128 px"));
  expect_error({"report", "measured", "--vectors", "nothing.csv"}, 2, "missing_file at nothing.csv");
  // an ambient density of 0 may be uncertain like any other number: g K times 0.02 kg/m^3
  write("measured/setup.toml", without_field + "[medium]\nambient_density_kg_m3 = { value = 0.0, sigma = 0.02 }\n");
  succeed({"report", "measured", "--format", "md", "-o", "text/vacuum.md", "--quiet"});
  EXPECT_THAT(read("text/vacuum.md"), testing::Not(HasSubstr("nan")));
  EXPECT_THAT(read("text/vacuum.md"),
              HasSubstr("| medium.ambient\\_density\\_kg\\_m3 | B | 0 | 0.02 | normal | infinite | 0.00"));
}

// A bin has at least 50 components of vectors. 64 px have 9 windows of 32 px, hence one bin, which shows no trend.
TEST_F(Reports, ShowNoReliabilityWithASingleBin) {
  render("case");
  succeed({"correlate", "case", "--quiet", "--set", "correlate.uncertainty=correlation_statistics", "--set",
           "correlate.window_px=[32]"});
  succeed({"report", "case", "--quiet"});
  std::string const html = read("case/report.html");
  EXPECT_THAT(html, HasSubstr("\"estimated uncertainty"));
  EXPECT_THAT(html, testing::Not(HasSubstr("Does the estimated uncertainty describe the error?")));
}

// The reports of a case and of a measurement end in the density of gladstone reconstruct, number by number; that of the
// case contains its error and the causes of the error.
TEST_F(Reports, HaveTheDensityOfReconstruct) {
  render("case");
  succeed({"correlate", "case", "--quiet", "--set", "correlate.uncertainty=correlation_statistics"});
  std::filesystem::create_directories(in("measured"));
  for (char const* const name : {"setup.toml", "reference.tif", "flow.tif", "vectors.h5"})
    std::filesystem::copy_file(in(std::string("case/") + name), in(std::string("measured/") + name));
  for (std::string const place : {"case", "measured"}) {
    std::vector<std::string> const gauge{"--reference",         "left", "--reference",         "top",
                                         "--reference-density", "1.3",  "--scale-uncertainty", "0.01"};
    std::vector<std::string> report{"report", place, "--quiet"},
        reconstruct{"reconstruct", place, "-o", "density.h5", "--no-figures", "--quiet"};
    report.insert(report.end(), gauge.begin(), gauge.end());
    reconstruct.insert(reconstruct.end(), gauge.begin(), gauge.end());
    bool const rendered = place == "case";
    if (rendered) reconstruct.emplace_back("--budget");
    nlohmann::json const expected = json_of(reconstruct);
    succeed(report);
    std::string const html = read(place + "/report.html");
    nlohmann::json const density = data_of(place + "/report.html")["density"];
    for (char const* const key : {"determined", "density_kg_m3", "sigma_kg_m3", "reference_density_kg_m3"})
      ASSERT_TRUE(density.contains(key)) << key;
    EXPECT_EQ(density.contains("error_kg_m3"), rendered);
    EXPECT_EQ(density.contains("budget_kg_m3"), rendered);
    for (auto const& [key, value] : density.items()) EXPECT_EQ(value, expected[key]) << place << ' ' << key;
    EXPECT_GT(density["sigma_kg_m3"]["median"].get<double>(), 0.0);
    EXPECT_THAT(html, HasSubstr("Maps of the density"));
    EXPECT_THAT(html, HasSubstr("Profile of the density"));
    EXPECT_THAT(html, HasSubstr("Numbers of the density"));
    EXPECT_EQ(html.find("Error budget of the density") != std::string::npos, rendered);
    EXPECT_THAT(html, HasSubstr("--reference left --reference top --reference-density 1.3 --scale-uncertainty 0.01"));
  }
}

TEST_F(Reports, RequireAReferenceForADensity) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  succeed({"report", "case", "--quiet"});
  EXPECT_THAT(read("case/report.html"), HasSubstr("No density was reconstructed"));
  EXPECT_FALSE(data_of("case/report.html").contains("density"));
  expect_error({"report", "case", "--reference", "900,900,999,999"}, 2, "invalid_value at reference");
  expect_error({"report", "case", "--deconvolve", "3"}, 2, "arguments at --reference");
  succeed({"report", "case", "--reference", "left", "--format", "md", "-o", "text/m.md", "--quiet"});
  EXPECT_THAT(read("text/m.md"), HasSubstr("density_profile.png"));
  EXPECT_TRUE(std::filesystem::exists(in("text/m_figures/density.png")));
  finish_study();
  expect_error({"report", "run", "--reference", "left"}, 2, "arguments at --reference");
}

// The setup of another camera than that of the frames, or other frames than those that were correlated.
TEST_F(Reports, OfAMeasurementKnowWhoseFramesAndVectorsTheyAre) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  std::filesystem::create_directories(in("measured"));
  for (char const* const name : {"reference.tif", "flow.tif", "vectors.h5"}) {
    std::filesystem::copy_file(in(std::string("case/") + name), in(std::string("measured/") + name));
  }
  std::string const setup = read("setup.toml");
  write("measured/setup.toml", with(setup, "pixels = [64, 64]", "pixels = [48, 32]"));
  expect_error({"report", "measured"}, 2, "wrong_shape at reference.tif");
  for (char const* const name : {"reference.tif", "flow.tif"})
    std::filesystem::remove(in(std::string("measured/") + name));
  expect_error({"report", "measured"}, 2, "inconsistent at vectors.h5");
  write("measured/setup.toml", setup);
  std::filesystem::copy_file(in("case/reference.tif"), in("measured/reference.tif"));
  std::filesystem::copy_file(in("case/reference.tif"), in("measured/flow.tif"));
  expect_error({"report", "measured"}, 2, "changed at vectors.h5", {"measured/flow.tif"});
  std::filesystem::remove(in("measured/vectors.h5"));
  expect_error({"report", "measured"}, 2, "missing_file at vectors.h5");
  // a frame of a case that has been replaced
  std::filesystem::copy_file(in("case/reference.tif"), in("case/flow.tif"),
                             std::filesystem::copy_options::overwrite_existing);
  expect_error({"report", "case"}, 2, "changed at flow.tif");
}

/// Returns the displacements along x of a file of vectors.
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

// A steady field is measured twice, with different noise: the standard deviation of a mean of two is half of their
// difference, with one degree of freedom (JCGM 100:2008, 4.2). One px is 150.9 kg/m^4.
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
[render]
method = "rays"
rays_per_dot = 64
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
  EXPECT_THAT(findings, ContainsWhole("coverage factor k = 13.97"));
  EXPECT_THAT(read("measured/report.html"), HasSubstr("<td>t, 1 degree of freedom</td>"));
  EXPECT_THAT(read("measured/report.html"), HasSubstr("is of type A: the standard deviation of the mean of 2 repeats"));
  EXPECT_THAT(read("measured/report.html"), HasSubstr("the error due to their pattern"));
  nlohmann::json const data = data_of("measured/report.html");
  nlohmann::json const random = map_of(data, "contribution of the displacement to it", 'u');
  double mean = 0;
  for (nlohmann::json const& value : random) mean += value.get<double>() / static_cast<double>(random.size());
  // the vectors are rounded to 1e-6 px, 0.5 % of a scatter of 1e-4 px for two of them; 150.9 has four digits
  EXPECT_NEAR(mean, scatter * 150.9, 0.01 * scatter * 150.9);
  write("measured/other.csv", "x_px,y_px,u_px,v_px\n10,10,0.1,0\n20,10,0.1,0\n");
  expect_error({"report", "measured", "--vectors", "measured/1.csv", "--repeats", "measured/1.csv"}, 2,
               "inconsistent at 1.csv");
  expect_error({"report", "measured", "--vectors", "measured/1.csv", "--repeats", "measured/other.csv"}, 2,
               "inconsistent at other.csv");
  expect_error({"report", "case1", "--repeats", "measured/2.csv"}, 2, "arguments at --repeats");
}

TEST_F(Reports, AreWrittenAsMarkdownWithFiguresBesideIt) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  succeed({"report", "case", "--format", "md", "-o", "text/report.md", "--figure-format", "svg", "--quiet"});
  EXPECT_THAT(read("text/report.md"), HasSubstr("![error\\_budget](<report_figures/error_budget.svg>)"));
  EXPECT_THAT(read("text/report_figures/error_budget.svg"), HasSubstr("</svg>"));
  succeed({"report", "case", "-o", "other/report.md", "--figure-format", "svg", "--quiet"});
  EXPECT_THAT(read("other/report.md"), HasSubstr("![error\\_budget](<report_figures/error_budget.svg>)"));
  expect_error({"report", "case", "-o", "report.pdf"}, 2, "output at report.pdf");
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
  expect_error({"report", "nowhere"}, 2, "wrong_format at nowhere");
  render("case");
  expect_error({"report", "case", "--quiet"}, 2, "missing_file at vectors.h5");
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 16]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--quiet", "--device", "cpu"});
  expect_error({"report", "run"}, 2, "missing_content at run");
  expect_error({"report", "case", "--format", "pdf"}, 2, "arguments at --format");
  expect_error({"report", "run", "--vectors", "vectors.csv"}, 2, "arguments at --vectors");
  write("cut.csv", "x_px,y_px,u_px,v_px\n10,10,0.1,0.2\n20,10,0.");
  expect_error({"report", "case", "--vectors", "cut.csv"}, 2, "syntax at cut.csv:3");
}

}  // namespace
}  // namespace gladstone::end_to_end
