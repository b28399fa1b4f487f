#include "analysis/correlation/correlator.h"

#include <fmt/format.h>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/optical_flow/optical_flow_correlator.h"
#include "analysis/correlation/standard_correlator.h"
#include "render/base/contracts.h"

namespace gladstone::inline correlation {
std::vector<std::string> correlation_methods() {
  std::vector<std::string> names;
  for (CorrelationMethod const& method : all_correlation_methods()) names.emplace_back(method.name);
  return names;
}

std::unique_ptr<Correlator> make_correlator(CorrelationSettings const& settings) {
  CorrelationMethod const& method = correlation_method(settings.method);
  GLADSTONE_EXPECTS(!method.tracks_dots);
  return method.optical_flow ? make_optical_flow_correlator(settings, method.optical_flow)
                             : make_standard_correlator(settings);
}

std::string missing_on_gpu(CorrelationSettings const& settings) {
  for (CorrelationMethod const& method : all_correlation_methods())
    if (settings.method == method.name && !method.on_gpu) return fmt::format("method = \"{}\"", method.name);
  if (settings.deformation == "sinc") return "deformation = \"sinc\"";
  return subpixel_method(settings.subpixel).on_gpu ? "" : fmt::format("subpixel = \"{}\"", settings.subpixel);
}

InterrogationGrid final_grid(CorrelationSettings const& settings, int columns, int rows) {
  return make_interrogation_grid(columns, rows, settings.window_px.back(), settings.overlap);
}

}  // namespace gladstone::inline correlation
