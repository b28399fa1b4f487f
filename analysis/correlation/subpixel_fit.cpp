#include "analysis/correlation/subpixel_fit.h"

#include <array>

#include "render/base/contracts.h"

namespace gladstone {
namespace {

struct NamedFit {
  char const* name;
  SubpixelFit fit;
  bool on_gpu = false;
};

/// Table of all subpixel fits.
constexpr std::array fits{
    NamedFit{"gauss3", fit_gauss3, true},
    NamedFit{"gauss2d", fit_gauss2d, true},
    NamedFit{"parabola", fit_parabola},
    NamedFit{"centroid", fit_centroid},
};

}  // namespace

std::vector<std::string> subpixel_fits() {
  std::vector<std::string> names;
  for (NamedFit const& row : fits) names.emplace_back(row.name);
  return names;
}

bool subpixel_fit_on_gpu(std::string const& name) {
  for (NamedFit const& row : fits)
    if (name == row.name) return row.on_gpu;
  GLADSTONE_EXPECTS(!"the name of a subpixel fit");
  return false;
}

SubpixelFit subpixel_fit(std::string const& name) {
  for (NamedFit const& row : fits)
    if (name == row.name) return row.fit;
  GLADSTONE_EXPECTS(!"the name of a subpixel fit");
  return nullptr;
}

}  // namespace gladstone
