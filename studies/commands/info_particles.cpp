#include "studies/commands/info_particles.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "render/base/units.h"
#include "studies/case/cameras.h"
#include "studies/case/case.h"
#include "studies/case/case_kind.h"
#include "studies/case/expected_particles.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"

namespace gladstone::inline commands {
namespace {

constexpr char const* adrian = "Adrian & Yao 1985; Raffel et al. 2018";
constexpr char const* olsen = "Olsen & Adrian 2000, Exp. Fluids 29:S166";

/// Adds the median of a quantity and the limits of 90 % of the particles.
void add_spread(std::vector<ResultRow>& rows, std::string const& key, std::string const& label,
                SizeSpread const& spread, double unit_value, char const* unit_name, char const* source) {
  for (auto const& [name, words, value] : {std::tuple{"median", "median", spread.median},
                                           {"p05", "exceeded by 95 %", spread.p05},
                                           {"p95", "exceeded by 5 %", spread.p95}}) {
    rows.push_back({.key = key + '.' + name,
                    .label = label + ", " + words,
                    .value = value / unit_value,
                    .unit = unit_name,
                    .source = source});
  }
}

std::vector<ResultRow> particle_rows(ExpectedParticles const& expected, CaseSetup const& loaded) {
  double const full_well = loaded.setup.camera.noise.full_well_e;
  std::vector<ResultRow> rows;
  auto const add = [&rows](char const* key, char const* symbol, std::string label, double value, char const* unit_name,
                           char const* source = "", std::string note = "") {
    rows.push_back({.key = key,
                    .symbol = symbol,
                    .label = std::move(label),
                    .value = value,
                    .unit = unit_name,
                    .source = source,
                    .note = std::move(note)});
  };
  add("magnification", "M", "magnification at the sheet", expected.magnification, "");
  add_spread(rows, "diameter_um", "particle diameter", expected.diameter, unit::micrometre, "um", "setup");
  add("image_diameter_px", "", "image diameter (e^-2)", expected.image_diameter_px, "px", olsen);
  add("image_diameter_sheet_edge_px", "", "image diameter at the edge of the sheet", expected.sheet_edge_diameter_px,
      "px", olsen);
  add("diffraction_diameter_px", "d_diff", "image diameter by diffraction only", expected.diffraction_px, "px", adrian);
  add("depth_of_field_mm", "", "depth of field", expected.depth_of_field / unit::millimetre, "mm", "Adrian 1991",
      fmt::format("the sheet is {:.4g} mm thick", loaded.setup.piv->laser.thickness / unit::millimetre));
  char const* const unread = std::isfinite(expected.per_pixel) ? "" : "before the file is read";
  add("particles_per_pixel", "", "particles per pixel, within the sheet", expected.per_pixel, "", "", unread);
  for (int const window : loaded.correlate.window_px)
    rows.push_back({.key = fmt::format("particles_in_{}_px", window),
                    .symbol = "N_I",
                    .label = fmt::format("particles in {} px", window),
                    .value = expected.per_pixel * window * window});
  add("source_density", "N_S", "fraction of the image covered by particles", expected.source_density, "",
      "Adrian 1991, Annu. Rev. Fluid Mech. 23:261", unread);
  add_spread(rows, "photons", "photons through the lens", expected.photons, 1, "", "Mie");
  add_spread(rows, "electrons_peak", "electrons at the peak", expected.peak_electrons, 1, "", "Mie");
  add("full_well_e", "", "full well", full_well, "e", "setup");
  add("saturated_fraction", "", "fraction of the particles that saturate", expected.saturated, "");
  add("smallest_visible_um", "", "smallest detectable particle", expected.smallest_visible / unit::micrometre, "um",
      "Rose 1948, J. Opt. Soc. Am. 38:196", "peak at five times its noise, up to 100 um");
  return rows;
}

/// Returns the rows as JSON, with the particles per window also as pairs of window size and number.
nlohmann::ordered_json particles_json(std::vector<ResultRow> const& rows, ExpectedParticles const& expected,
                                      CaseSetup const& loaded) {
  nlohmann::ordered_json json = rows_json(rows);
  for (int const window : loaded.correlate.window_px)
    json["particles_per_window"].push_back({window, number_or_null(expected.per_pixel * window * window)});
  return json;
}

}  // namespace

Description describe_particles(SetupDocument const& setup, std::string const& name) {
  std::string text;
  std::vector<ResultRow> all;
  nlohmann::ordered_json cameras = nlohmann::ordered_json::object(), only;
  for (auto const& [camera, loaded] : load_cameras(setup)) {
    require_experiment(loaded.setup, piv_experiment, name,
                       "has no particles (experiment is not \"piv\"); give the setup of a PIV experiment");
    log_warnings(loaded.warnings);
    ExpectedParticles const expected = expected_particles(loaded.setup);
    text += fmt::format("{}{}\n", name, camera.empty() ? "" : ", camera " + camera);
    std::vector<ResultRow> const rows = particle_rows(expected, loaded);
    text += rows_text(rows);
    only = particles_json(rows, expected, loaded);
    append_rows(all, rows, camera);
    if (!camera.empty()) cameras[camera] = only;
  }
  nlohmann::ordered_json const json = cameras.empty() ? only : nlohmann::ordered_json{{"cameras", cameras}};
  return {json_text(json), text, std::move(all)};
}

}  // namespace gladstone::inline commands
