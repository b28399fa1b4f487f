#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "render/files/hdf5_file.h"
#include "render/files/image_file.h"
#include "tests/end_to_end/support/program.h"
#include "tests/support/contains_whole.h"
#include "tests/support/folder_fixture.h"

namespace gladstone::end_to_end {

/// Setup of a small experiment that is rendered in a tenth of a second: 64 x 64 px with a uniform gradient, ray by ray.
inline constexpr char const* small_setup = R"(schema = 1
experiment = "bos"

[camera]
pixels = [64, 64]
pixel_pitch_um = 10.0

[lens]
focal_length_mm = 105.0
f_number = 11.0

[geometry]
z_a_mm = 750.0
z_d_mm = 250.0

[medium.field]
kind = "uniform_gradient"
gradient_kg_m4 = [20.0, 10.0, 0.0]

[target]
dots_per_32px_window = 10.0

[render]
method = "rays"
rays_per_dot = 32

[correlate]
window_px = [32, 16]
overlap = 0.5
)";

/// Returns a setup with one part of its text replaced.
inline std::string with(std::string text, std::string const& old, std::string const& replacement) {
  auto const at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return at == std::string::npos ? text : text.replace(at, old.size(), replacement);
}

/// Returns the setup of the small experiment with render.method = "auto", which selects the fast renderer. This
/// renderer measures the error of its table with a million rays, which takes a second.
inline std::string automatic_setup() { return with(small_setup, "method = \"rays\"\n", ""); }

/// Returns the position "line:column" of a piece of text, counted as by the program.
inline std::string place_of(std::string const& text, std::string const& piece) {
  auto const at = text.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  auto const line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
  auto const start = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  return std::to_string(line) + ':' + std::to_string(start == std::string::npos ? at + 1 : at - start);
}

/// Fixture that creates a new folder for each test, in which the program runs.
class ProgramFixture : public FolderFixture {
 protected:
  void SetUp() override {
    FolderFixture::SetUp();
    write("setup.toml", small_setup);
  }

  std::filesystem::path in(std::string const& name) const { return folder_ / name; }
  std::string read(std::string const& name) const { return content(folder_ / name); }

  Outcome gladstone(std::vector<std::string> arguments) const { return run(std::move(arguments), folder_); }

  /// Runs a command that must succeed, and returns its stdout.
  std::string succeed(std::vector<std::string> arguments) const {
    Outcome const outcome = gladstone(std::move(arguments));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  }
  /// Runs a command that must succeed, and returns the JSON object on its stdout.
  nlohmann::json json_of(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    std::string const out = succeed(std::move(arguments));
    auto const json = nlohmann::json::parse(out, nullptr, false);
    EXPECT_TRUE(json.is_object()) << out;
    return json;
  }
  /// Renders the setup into a case, with additional arguments.
  void render(std::string const& name, std::vector<std::string> const& more = {},
              std::string const& setup = "setup.toml") const {
    std::vector<std::string> arguments{"render", setup, "-o", name, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    succeed(arguments);
  }

  /// Returns the contents of the folder as a map from path to file content; paths of folders end in '/'.
  std::map<std::string, std::string> everything() const {
    std::map<std::string, std::string> found;
    for (auto const& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      std::string const name = std::filesystem::relative(entry.path(), folder_).string();
      entry.is_directory() ? found[name + '/'] = "" : found[name] = content(entry.path());
    }
    return found;
  }

  /// Expects the command to fail with this exit code and an error of this code and place, and to change no file.
  /// @param error  "syntax at v.csv:3": code, and name of the file without its folders, with line and column if known
  /// @param values  names and whole numbers that the message contains; its wording is free
  void expect_error(std::vector<std::string> arguments, int exit_code, std::string const& error,
                    std::vector<std::string> const& values = {}) const {
    auto const before = everything();
    arguments.emplace_back("--json");
    Outcome const outcome = gladstone(std::move(arguments));
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err << " (signal " << outcome.signal << ')';
    expect_error_in(outcome, error, values);
    EXPECT_TRUE(everything() == before) << "files changed: " << testing::PrintToString(names());
  }
  /// Expects the output of a command with --json to contain an error of this code and place; see expect_error().
  static void expect_error_in(Outcome const& outcome, std::string const& error,
                              std::vector<std::string> const& values = {}) {
    auto const errors = errors_in(outcome.out);
    EXPECT_THAT(errors, testing::Contains(error)) << outcome.err;
    auto const at = std::find(errors.begin(), errors.end(), error) - errors.begin();
    if (at == std::ssize(errors)) return;
    std::string const message = nlohmann::json::parse(outcome.out)["errors"][static_cast<std::size_t>(at)]["message"];
    for (std::string const& value : values) EXPECT_THAT(message, ContainsWhole(value)) << error;
  }
  /// Returns the errors in the output of a command with --json, each as "code at place".
  static std::vector<std::string> errors_in(std::string const& output) {
    std::vector<std::string> found;
    auto const json = nlohmann::json::parse(output, nullptr, false);
    if (!json.is_object() || !json.contains("errors")) return found;
    for (nlohmann::json const& error : json["errors"]) {
      std::string place = error.value("place", "");
      if (place.size() > 1 && place.ends_with('/')) place.pop_back();
      found.push_back(error.value("code", "") + " at " + std::filesystem::path(place).filename().string());
    }
    return found;
  }
  /// Returns the warnings of an object of --json or of a summary.json, each as "code at place", or "code" without one.
  static std::vector<std::string> warnings_in(nlohmann::json const& json) {
    std::vector<std::string> found;
    for (nlohmann::json const& warning : json.at("warning_records")) {
      std::string const place = std::filesystem::path(warning.at("place").get<std::string>()).filename().string();
      found.push_back(warning.at("code").get<std::string>() + (place.empty() ? "" : " at " + place));
    }
    EXPECT_EQ(found.size(), json.at("warnings").size());
    return found;
  }
  /// Expects an object of --json or a summary.json to contain a warning of this code and place.
  /// @param values  names and whole numbers that its text contains; its wording is free
  static void expect_warning_in(nlohmann::json const& json, std::string const& warning,
                                std::vector<std::string> const& values = {}) {
    auto const warnings = warnings_in(json);
    EXPECT_THAT(warnings, testing::Contains(warning));
    auto const at = std::find(warnings.begin(), warnings.end(), warning) - warnings.begin();
    if (at == std::ssize(warnings)) return;
    std::string const text = json.at("warning_records")[static_cast<std::size_t>(at)].at("text");
    for (std::string const& value : values) EXPECT_THAT(text, ContainsWhole(value)) << warning;
  }
  /// Expects the rendering of this setup text to fail with an error of this code and place.
  void expect_setup_error(std::string const& text, std::string const& error,
                          std::vector<std::string> const& values = {}) const {
    write("setup.toml", text);
    expect_error({"render", "setup.toml", "-o", "case"}, 2, error, values);
  }

  std::vector<std::string> names(std::string const& folder = ".") const {
    std::vector<std::string> found;
    for (auto const& entry : std::filesystem::directory_iterator(folder_ / folder))
      found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  }

  /// Expects two cases to have identical pixels and truth, bit by bit.
  void expect_same_case(std::string const& a, std::string const& b) const {
    for (std::string const image : {"/reference.tif", "/flow.tif"}) {
      Image<double> const one = read_image(in(a + image).string()), other = read_image(in(b + image).string());
      ASSERT_EQ(one.columns(), other.columns());
      EXPECT_TRUE(std::equal(one.begin(), one.end(), other.begin(), other.end())) << a << b << image;
    }
    expect_same_datasets(a + "/truth.h5", b + "/truth.h5");
  }
  void expect_same_datasets(std::string const& a, std::string const& b) const {
    Hdf5Reader const one(in(a).string()), other(in(b).string());
    auto const datasets = datasets_of(one, a);
    for (auto const& name : datasets) {
      auto const x = one.read(name), y = other.read(name);
      ASSERT_EQ(x.size(), y.size()) << name;
      EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(double)), 0) << a << ' ' << b << ' ' << name;
    }
  }
  static std::vector<std::string> datasets_of(Hdf5Reader const& file, std::string const& name) {
    if (name.find("truth") == std::string::npos) return file.dataset_names();
    return {"/dots/position_m", "/dots/reference_px", "/dots/displacement_px", "/dots/displacement_std_px",
            "/dots/rays",       "/dots/eq9_px",       "/dots/eq9_cone_px",     "/rays/status"};
  }
};

}  // namespace gladstone::end_to_end
