#include "studies/drawing/figure.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "render/base/contracts.h"

namespace gladstone::inline drawing {

std::string house_colour(std::size_t index) {
  constexpr std::array<char const*, 7> colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                               "#e69f00", "#56b4e9", "#404040"};
  return colours[index % colours.size()];
}

std::vector<plot::Tick> linear_ticks(double low, double high, double most) {
  GLADSTONE_EXPECTS(low < high && most >= 1);
  double const least = (high - low) / most, power = std::pow(10.0, std::floor(std::log10(least)));
  double step = 10 * power;
  for (double const factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= least) step = factor * power;
  }
  constexpr double rounding = 1e-9;
  std::vector<plot::Tick> ticks;
  for (double k = std::ceil(low / step - rounding); k * step <= high + rounding * step; ++k) {
    double const at = k * step + 0.0;  // no "-0"
    ticks.push_back({at, fmt::format("{:.6g}", at)});
  }
  return ticks;
}

std::vector<plot::Tick> logarithmic_ticks(double low, double high) {
  GLADSTONE_EXPECTS(low > 0 && high > low);
  bool const fine = std::log10(high / low) < 3.0;
  std::vector<plot::Tick> ticks;
  for (double power = std::pow(10.0, std::floor(std::log10(low))); power <= high; power *= 10) {
    for (double const factor : {1.0, 2.0, 5.0}) {
      double const at = factor * power;
      bool const inside = at >= low * (1 - 1e-9) && at <= high * (1 + 1e-9);
      if (inside && (fine || factor == 1)) ticks.push_back({at, fmt::format("{:.3g}", at)});
    }
  }
  return ticks;
}

}  // namespace gladstone::inline drawing
