#include "analysis/correlation/correlator.h"

#include <array>

#include "analysis/correlation/standard_correlator.h"
#include "analysis/correlation/window_ops.h"
#include "render/base/contracts.h"

namespace gladstone {
namespace {

struct Method {
  char const* name;
  std::unique_ptr<Correlator> (*make)(CorrelationSettings const&);
};

/// Every correlation method, one row each.
constexpr std::array methods{
    Method{"scc", make_standard_correlator},
};

}  // namespace

std::vector<std::string> correlation_methods() {
  std::vector<std::string> names;
  for (Method const& method : methods) names.emplace_back(method.name);
  return names;
}

std::unique_ptr<Correlator> make_correlator(CorrelationSettings const& settings) {
  for (Method const& method : methods)
    if (settings.method == method.name) return method.make(settings);
  GLADSTONE_EXPECTS(!"settings.method is a known correlation method");
  return nullptr;
}

double window_weight(CorrelationSettings const& settings, double dx_px, double dy_px) {
  double const window = settings.window_px.back();
  WindowWeighting const weighting = window_weighting(settings);
  return axis_weight(weighting, dx_px, window) * axis_weight(weighting, dy_px, window);
}

double window_support_px(CorrelationSettings const& settings) {
  return window_half_support(window_weighting(settings), static_cast<double>(settings.window_px.back()));
}

InterrogationGrid final_grid(CorrelationSettings const& settings, int columns, int rows) {
  return make_interrogation_grid(columns, rows, settings.window_px.back(), settings.overlap);
}

}  // namespace gladstone
