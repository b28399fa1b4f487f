#include "analysis/correlation/subpixel_fit.h"

#include <array>

#include "render/base/contracts.h"

namespace gladstone::inline correlation {
namespace {

/// Table of all subpixel fits.
constexpr std::array fits{
    SubpixelMethod{.name = "gauss3", .fit = fit_gauss3, .on_gpu = true},
    SubpixelMethod{.name = "gauss2d", .fit = fit_gauss2d, .on_gpu = true, .nine_points = true},
    SubpixelMethod{.name = "parabola", .fit = fit_parabola},
    SubpixelMethod{.name = "centroid", .fit = fit_centroid},
};

}  // namespace

std::vector<std::string> subpixel_fits() {
  std::vector<std::string> names;
  for (SubpixelMethod const& row : fits) names.emplace_back(row.name);
  return names;
}

SubpixelMethod const& subpixel_method(std::string const& name) {
  for (SubpixelMethod const& row : fits)
    if (name == row.name) return row;
  GLADSTONE_EXPECTS(!"the name of a subpixel fit");
  return fits.front();
}

}  // namespace gladstone::inline correlation
