#include "studies/commands/info_particles.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "render/base/units.h"
#include "studies/case/cameras.h"
#include "studies/case/case.h"
#include "studies/case/case_kind.h"
#include "studies/case/expected_particles.h"
#include "studies/case/json_text.h"

namespace gladstone {
namespace {

nlohmann::json spread_json(SizeSpread const& spread, double factor = 1) {
  return {{"p05", spread.p05 * factor}, {"median", spread.median * factor}, {"p95", spread.p95 * factor}};
}

nlohmann::json particles_json(ExpectedParticles const& expected, CaseSetup const& loaded) {
  nlohmann::json windows = nlohmann::json::array();
  for (int const window : loaded.correlate.window_px) {
    windows.push_back({window, number_or_null(expected.per_pixel * window * window)});
  }
  return {{"magnification", expected.magnification},
          {"diameter_um", spread_json(expected.diameter, 1 / unit::micrometre)},
          {"image_diameter_px", expected.image_diameter_px},
          {"image_diameter_sheet_edge_px", expected.sheet_edge_diameter_px},
          {"diffraction_diameter_px", expected.diffraction_px},
          {"depth_of_field_mm", expected.depth_of_field / unit::millimetre},
          {"particles_per_pixel", number_or_null(expected.per_pixel)},
          {"particles_per_window", windows},
          {"source_density", number_or_null(expected.source_density)},
          {"photons", spread_json(expected.photons)},
          {"electrons_peak", spread_json(expected.peak_electrons)},
          {"full_well_e", loaded.setup.camera.noise.full_well_e},
          {"saturated_fraction", expected.saturated},
          {"smallest_visible_um", number_or_null(expected.smallest_visible / unit::micrometre)}};
}

std::string particles_text(ExpectedParticles const& expected, CaseSetup const& loaded) {
  std::string text;
  auto const line = [&text](char const* name, std::string const& value) {
    text += fmt::format("  {:<22}{}\n", name, value);
  };
  auto const spread = [](SizeSpread const& s, double factor, char const* unit_name) {
    return fmt::format("{:.4g}{} (90 % from {:.4g} to {:.4g})", s.median * factor, unit_name, s.p05 * factor,
                       s.p95 * factor);
  };
  line("magnification", fmt::format("{:.5g} at the sheet", expected.magnification));
  line("particle diameter", spread(expected.diameter, 1 / unit::micrometre, " um"));
  line("image diameter",
       fmt::format("{:.3g} px (e^-2), {:.3g} px at the edge of the sheet; diffraction only {:.3g} px",
                   expected.image_diameter_px, expected.sheet_edge_diameter_px, expected.diffraction_px));
  line("depth of field", fmt::format("{:.4g} mm (the sheet is {:.4g} mm thick)", expected.depth_of_field * 1e3,
                                     loaded.setup.piv->laser.thickness * 1e3));
  if (std::isfinite(expected.per_pixel)) {
    line("particles per pixel", fmt::format("{:.4g} within the sheet's thickness (source density {:.3g})",
                                            expected.per_pixel, expected.source_density));
    std::string windows;
    for (int const window : loaded.correlate.window_px) {
      windows +=
          fmt::format("{}{:.3g} in {} px", windows.empty() ? "" : ", ", expected.per_pixel * window * window, window);
    }
    line("particles per window", windows);
  } else {
    line("particles per window", "unknown before the file is read");
  }
  line("photons", spread(expected.photons, 1, "") + " through the lens");
  line("electrons at the peak",
       spread(expected.peak_electrons, 1, "") + fmt::format(" of {:.5g}", loaded.setup.camera.noise.full_well_e));
  line("saturated", fmt::format("{:.3g} % of particles", 100 * expected.saturated));
  line("smallest seen", std::isfinite(expected.smallest_visible)
                            ? fmt::format("{:.3g} um (peak at five times its noise)", expected.smallest_visible * 1e6)
                            : std::string("none up to 100 um"));
  return text;
}

}  // namespace

Description describe_particles(SetupDocument const& setup, std::string const& name) {
  std::string text;
  nlohmann::json cameras = nlohmann::json::object(), only;
  for (CameraCase& camera : camera_cases(setup)) {
    CaseSetup const loaded = load_case_setup(std::move(camera.document));
    require_experiment(loaded.setup, piv_experiment, name,
                       "has no particles (experiment is not \"piv\"); give the setup of a PIV experiment");
    for (std::string const& warning : loaded.warnings) spdlog::warn("{}", warning);
    ExpectedParticles const expected = expected_particles(loaded.setup);
    text += fmt::format("{}{}\n", name, camera.name.empty() ? "" : ", camera " + camera.name);
    text += particles_text(expected, loaded);
    only = particles_json(expected, loaded);
    if (!camera.name.empty()) cameras[camera.name] = only;
  }
  nlohmann::json const json = cameras.empty() ? only : nlohmann::json{{"cameras", cameras}};
  return {json_text(json), text};
}

}  // namespace gladstone
