// The tables of docs/file-formats.md and the files that are written name the same datasets and keys.
#include <set>
#include <sstream>

#include "tests/end_to_end/support/program_fixture.h"
#include "tests/support/documented_tables.h"

namespace gladstone::end_to_end {
namespace {

using test::documented_table;
using test::documented_tables;
using test::names_of;
using test::names_of_first_column;

/// Returns true if a JSON object has this path, such as "spot.model".
bool has_path(nlohmann::json const& object, std::string const& path) {
  std::istringstream steps(path);
  nlohmann::json const* at = &object;
  for (std::string step; std::getline(steps, step, '.');) {
    if (!at->is_object() || !at->contains(step)) return false;
    at = &(*at)[step];
  }
  return true;
}

class DocumentedFiles : public ProgramFixture {
 protected:
  /// Expects the numeric datasets of a file to be the documented ones, with the attributes that every file has.
  void expect_datasets(std::string const& name, std::set<std::string> const& documented) const {
    Hdf5Reader const file(in(name).string());
    for (std::string const& dataset : documented) {
      ASSERT_TRUE(file.has(dataset)) << name << " lacks " << dataset;
      for (char const* attribute : {"units", "description", "axes"})
        EXPECT_NE(file.attribute_of(dataset, attribute), "") << name << dataset << attribute;
    }
    for (std::string const& dataset : file.number_datasets())
      EXPECT_TRUE(documented.contains(dataset)) << name << ": " << dataset << " is not in docs/file-formats.md";
    for (char const* attribute :
         {"filetype", "version", "software_version", "git_sha1", "date_and_time", "setup", "seed", "device"})
      EXPECT_NE(file.attribute(attribute), "") << name << attribute;
  }

  /// Expects a summary to have exactly the documented keys, except for the absent ones.
  void expect_summary(std::string const& name, std::set<std::string> const& absent) const {
    auto const summary = nlohmann::json::parse(read(name));
    std::set<std::string> known;
    for (std::string const& key : names_of_first_column(documented_table("summary.json", "key"))) {
      EXPECT_EQ(has_path(summary, key), !absent.contains(key)) << name << ": " << key;
      known.insert(key.substr(0, key.find('.')));
    }
    for (auto const& item : summary.items())
      EXPECT_TRUE(known.contains(item.key())) << name << ": " << item.key() << " is not in docs/file-formats.md";
  }
};

TEST_F(DocumentedFiles, TablesAreReadRowByRow) {
  EXPECT_EQ(names_of("`/pinhole/camera_matrix`, `distortion`, or `/dots/plane`"),
            (std::vector<std::string>{"/pinhole/camera_matrix", "/pinhole/distortion", "/dots/plane"}));
  EXPECT_EQ(documented_tables("truth.h5", "dataset").size(), 2u) << "one table for BOS, one for PIV";
  EXPECT_GT(names_of_first_column(documented_table("summary.json", "key")).size(), 20u);
}

TEST_F(DocumentedFiles, OfACaseHoldWhatTheirTablesName) {
  write("setup.toml", with(automatic_setup(), "rays_per_dot = 32", "rays_per_dot = \"auto\""));
  render("case");
  expect_datasets("case/truth.h5", names_of_first_column(documented_table("truth.h5", "dataset")));
  Hdf5Reader const truth(in("case/truth.h5").string());
  EXPECT_EQ(truth.attribute("method"), "focused_dots");
  expect_summary("case/summary.json", {"particles"});
  auto const summary = nlohmann::json::parse(read("case/summary.json"));
  for (char const* hash : {"reference_sha256", "flow_sha256"}) EXPECT_EQ(truth.attribute(hash), summary[hash]);
  EXPECT_TRUE(nlohmann::json::parse(truth.attribute("inputs_sha256")).is_object());

  succeed({"correlate", "case"});
  succeed({"correlate", "case", "-o", "v.csv"});
  std::string columns;
  std::set<std::string> datasets;
  for (auto const& cells : documented_table("vectors.h5, vectors.csv", "column")) {
    for (std::string const& name : names_of(cells[0])) {
      datasets.insert('/' + name);
      columns += (columns.empty() ? "" : ",") + name;
    }
  }
  datasets.merge(names_of_first_column(documented_table("vectors.h5, vectors.csv", "dataset")));
  expect_datasets("case/vectors.h5", datasets);
  std::string const text = read("v.csv");
  EXPECT_EQ(text.substr(0, text.find('\n')), columns);
  Hdf5Reader const vectors(in("case/vectors.h5").string());
  for (char const* hash : {"reference_sha256", "flow_sha256"}) EXPECT_EQ(vectors.attribute(hash), summary[hash]);
  for (char const* attribute : {"grid_columns", "grid_rows", "verdict", "verdict_code", "verdict_number",
                                "uncertainty_method", "uncertainty_key"})
    EXPECT_NE(vectors.attribute(attribute), "");

  succeed({"compare", "case", "--no-figures"});
  Hdf5Reader const comparison(in("case/comparison.h5").string());
  for (char const* dataset : {"eq9_px", "chief_px", "eq9_cone_px", "thin_lens_px", "ray_truth_px", "window_truth_px",
                              "deformed_window_truth_px", "noise_free_px", "counts"})
    EXPECT_TRUE(comparison.has(std::string("/vectors/") + dataset)) << dataset;
  EXPECT_EQ(comparison.attribute("filetype"), "gladstone comparison");
  for (char const* attribute : {"errors_sha256", "made_from"}) EXPECT_NE(comparison.attribute(attribute), "");
}

TEST_F(DocumentedFiles, OfADensityHoldWhatTheirTablesName) {
  render("case");
  succeed({"correlate", "case", "-o", "v.csv"});
  auto const tables = documented_tables("density.h5", "dataset");
  ASSERT_EQ(tables.size(), 2u) << "one table for every file, one for rendered cases";
  std::set<std::string> documented = names_of_first_column(tables[0]);
  succeed(
      {"reconstruct", "setup.toml", "--vectors", "v.csv", "--reference", "left", "-o", "density.h5", "--no-figures"});
  expect_datasets("density.h5", documented);
  documented.merge(names_of_first_column(tables[1]));
  write("blob.toml", with(small_setup, "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
                          "kind = \"gaussian_blob\"\namplitude_kg_m3 = -0.2\nradius_mm = 1.0"));
  succeed({"render", "blob.toml", "-o", "blob"});
  succeed({"correlate", "blob", "-o", "blob.csv"});
  auto const summary = json_of({"reconstruct", "blob", "--vectors", "blob.csv", "--axisymmetric", "--axis", "x=0", "-o",
                                "density.h5", "--no-figures"});
  expect_datasets("density.h5", documented);
  Hdf5Reader const file(in("density.h5").string());
  for (char const* attribute : {"reference_density_kg_m3", "window_overlap_x", "window_overlap_y", "white_noise_gain",
                                "samples", "axisymmetric", "axis_direction", "axis_mm", "axis_sigma_mm", "lambda",
                                "asymmetry", "border_gradient", "vectors_sha256", "truth_sha256"})
    EXPECT_NE(file.attribute(attribute), "") << attribute;
  for (char const* key : {"vectors", "columns", "rows", "determined", "density_kg_m3.least", "density_kg_m3.median",
                          "sigma_kg_m3.largest", "sigma_random_kg_m3.largest", "reference_density_kg_m3",
                          "white_noise_gain", "axis.position_mm", "file", "error_kg_m3.count", "error_kg_m3.bias",
                          "error_kg_m3.rms", "error_kg_m3.largest", "error_kg_m3.contrast", "error_kg_m3.coverage"})
    EXPECT_TRUE(has_path(summary, key)) << key;
}

TEST_F(DocumentedFiles, OfAStereoMeasurementHoldWhatTheirTablesName) {
  succeed({"init", "stereo", "-o", "stereo.toml"});
  render("case", {"--set", "particles.per_pixel=0.02"}, "stereo.toml");
  for (char const* camera : {"case/left", "case/right"}) succeed({"correlate", camera});
  auto const summary = json_of({"stereo", "case/left", "case/right", "-o", "uvw.h5", "--no-figures"});
  auto const tables = documented_tables("Files of gladstone stereo", "dataset");
  ASSERT_EQ(tables.size(), 2u) << "one table for every file, one for rendered cases";
  std::set<std::string> documented = names_of_first_column(tables[0]);
  documented.merge(names_of_first_column(tables[1]));
  expect_datasets("uvw.h5", documented);
  Hdf5Reader const file(in("uvw.h5").string());
  for (char const* attribute : {"sheet_z_mm", "sheet_slope_x", "sheet_slope_y", "pixel_size_mm", "view_angle_deg",
                                "window_a_px", "window_b_px", "vectors_a_sha256", "truth_b_sha256"})
    EXPECT_NE(file.attribute(attribute), "") << attribute;
  for (char const* key : {"vectors",
                          "calibrations",
                          "columns",
                          "rows",
                          "determined",
                          "rejected",
                          "given_sheet.disparity_px",
                          "given_sheet.scatter_px",
                          "spacing_mm",
                          "pixel_size_mm",
                          "view_angle_deg",
                          "residual_px",
                          "residual_ratio",
                          "u.mean_mm",
                          "v.deviation_mm",
                          "w.sigma_mm",
                          "error.u.count",
                          "error.v.bias_px",
                          "error.w.rms_px",
                          "error.w.rms_mm",
                          "error.w.coverage",
                          "file"})
    EXPECT_TRUE(has_path(summary, key)) << key;
}

TEST_F(DocumentedFiles, OfACaseOfPivHoldWhatTheirTablesName) {
  write("setup.toml", R"(experiment = "piv"
[camera]
pixels = [64, 64]
pixel_pitch_um = 10.0
[lens]
f_number = 22.0
[geometry]
z_a_mm = 750.0
[particles]
number = 200
volume_mm = [6.0, 6.0, 1.5]
[laser]
thickness_mm = 1.0
[flow]
velocity_m_s = [14.0, 0.0, 0.0]
dt_us = 10.0
)");
  render("case");
  auto const tables = documented_tables("truth.h5", "dataset");
  std::set<std::string> documented = names_of_first_column(tables.at(1));
  documented.insert("/rays/status");  // from the first table, since it does not belong to dots
  expect_datasets("case/truth.h5", documented);
  expect_summary("case/summary.json", {});
  auto const particles = nlohmann::json::parse(read("case/summary.json"))["particles"];
  for (char const* key : {"seeded", "not_traced", "lit", "in_view", "per_pixel", "paired_fraction", "photons.least",
                          "photons.median", "photons.most", "electrons_per_photon", "path.steps", "path.error_px",
                          "path.lag_error_px", "scattering_table_error"})
    EXPECT_TRUE(has_path(particles, key)) << key;
}

TEST_F(DocumentedFiles, OfACalibrationHoldWhatTheirTablesName) {
  write("setup.toml", R"(experiment = "calibration"
[camera]
pixels = [320, 240]
pixel_pitch_um = 20.0
[lens]
focal_length_mm = 24.0
f_number = 11.0
[geometry]
z_a_mm = 300.0
[calibration]
planes_mm = [-20.0, 0.0, 20.0]
spacing_mm = 5.0
dot_diameter_mm = 1.5
extent_mm = [60.0, 45.0]
[render]
rays_per_dot = 256
)");
  render("case");
  expect_datasets("case/truth.h5",
                  names_of_first_column(documented_table("plane_000.tif and truth.h5 of a calibration", "dataset")));
  succeed({"calibrate", "case", "--quiet", "--no-figures"});
  expect_datasets("case/calibration.h5", names_of_first_column(documented_table("calibration.h5", "dataset")));
  auto const planes = nlohmann::json::parse(read("case/summary.json"))["planes"];
  ASSERT_EQ(planes.size(), 3u);
  Hdf5Reader const calibration(in("case/calibration.h5").string());
  for (std::size_t i = 0; i < 3; ++i) {
    for (char const* key : {"file", "z_mm", "dots", "dots_unseen", "saturated", "magnification", "sha256",
                            "rays_planned", "place_error_px.rms", "place_error_px.largest", "place_error_px.dots"})
      EXPECT_TRUE(has_path(planes[i], key)) << key;
    EXPECT_EQ(calibration.attribute("plane_00" + std::to_string(i) + "_sha256"), planes[i]["sha256"]);
  }
}

// Correct foreign vectors: errors.json describes their numbers and conventions.
TEST_F(DocumentedFiles, OfForeignVectorsSayHowTheyWereRead) {
  render("case");
  succeed({"correlate", "case", "-o", "v.csv"});
  std::istringstream ours(read("v.csv"));
  std::string text = "x,y,u,v\n", line;
  std::getline(ours, line);
  while (std::getline(ours, line)) {
    std::size_t end = 0;
    for (int i = 0; i < 4; ++i) end = line.find(',', end + 1);
    text += line.substr(0, end) + '\n';
  }
  write("other.csv", text);
  auto const errors = json_of({"compare", "case", "--no-figures", "--vectors", "other.csv"});
  for (char const* key :
       {"total", "left_out_place_not_finite", "left_out_outside_image", "left_out_displacement_not_finite",
        "left_out_displacement_beyond_image", "left_out_fewer_than_three_dots", "conventions", "fit.conventions",
        "fit.rms_px", "fit.verdict", "fit.likely_mistake", "fit.ambiguous", "fit.signal_px", "fit.slope",
        "fit.offset_px", "fit.rms_without_offset_px", "fit.tried"})
    EXPECT_TRUE(has_path(errors["vectors"], key)) << key;
  EXPECT_EQ(errors["made_from"]["frames"], "unverified");
}

// Each key of [correlate] has the documented default.
TEST_F(DocumentedFiles, OfVectorsHaveTheDocumentedDefaults) {
  render("case", {"--set", "camera.pixels=[128, 128]"});
  write("plain.toml", "[correlate]\n");
  succeed({"correlate", "case/reference.tif", "case/flow.tif", "--config", "plain.toml", "-o", "v.h5"});
  std::string const settings = Hdf5Reader(in("v.h5").string()).attribute("setup");
  auto const value_of = [&](std::string const& key) {
    auto const at = settings.find('\n' + key + " = ");
    EXPECT_NE(at, std::string::npos) << key << " in " << settings;
    if (at == std::string::npos) return std::string();
    auto const from = at + key.size() + 4;
    return settings.substr(from, settings.find('\n', from) - from);
  };
  std::size_t keys = 0;
  for (auto const& cells : documented_table("vectors.h5, vectors.csv", "key")) {
    auto const names = names_of(cells[0]);
    auto const defaults = nlohmann::json::parse(names.size() > 1 ? '[' + cells[1] + ']' : cells[1]);
    for (std::size_t i = 0; i < names.size(); ++i, ++keys) {
      auto const documented = names.size() > 1 ? defaults[i] : defaults;
      EXPECT_EQ(nlohmann::json::parse(value_of(names[i]), nullptr, false), documented) << names[i];
    }
  }
  EXPECT_GT(keys, 15u);
}

// Each key of [correlate.tracking] has the documented default, and all keys are documented.
TEST_F(DocumentedFiles, OfTrackedDotsHaveTheDocumentedDefaults) {
  render("case");
  write("plain.toml", "[correlate]\nwindow_px = [32]\nmethod = \"tracking\"\n");
  succeed({"correlate", "case/reference.tif", "case/flow.tif", "--config", "plain.toml", "-o", "v.h5"});
  std::string const settings = Hdf5Reader(in("v.h5").string()).attribute("setup");
  std::string const title = "[correlate.tracking]\n";
  auto const at = settings.find(title);
  ASSERT_NE(at, std::string::npos) << settings;
  std::map<std::string, std::string> values;
  std::istringstream table(settings.substr(at + title.size()));
  for (std::string line; std::getline(table, line) && line.find(" = ") != std::string::npos;)
    values[line.substr(0, line.find(" = "))] = line.substr(line.find(" = ") + 3);
  std::map<std::string, std::string> documented;
  for (auto const& cells : documented_table("vectors.h5, vectors.csv", "`[correlate.tracking]` key"))
    documented[names_of(cells[0]).at(0)] = cells[1];
  EXPECT_EQ(values, documented);
}

}  // namespace
}  // namespace gladstone::end_to_end
