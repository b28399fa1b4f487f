#include "analysis/correlation/correlation_settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/correlation/correlation_methods.h"

namespace gladstone::inline correlation {

bool CorrelationSettings::gives_scattered_vectors() const {
  return correlation_method(method).tracks_dots && tracking.output == "scattered";
}

std::string window_problem(CorrelationSettings const& settings, int columns, int rows) {
  int const largest = *std::max_element(settings.window_px.begin(), settings.window_px.end());
  if (largest <= std::min(columns, rows)) return {};
  return fmt::format("a window of {} px does not fit into an image of {} x {} px; use windows up to {} px", largest,
                     columns, rows, std::min(columns, rows) / 2 * 2);
}

}  // namespace gladstone::inline correlation
