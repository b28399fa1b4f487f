#include "studies/compare/uncorrected_bias.h"

#include <cmath>

namespace gladstone::inline compare {

std::string describe_uncorrected_bias(ComparisonKind const& kind) {
  return std::string("the true displacement averaged over the window minus the displacement ") + kind.bias +
         ", rms over the vectors. " + kind.bias_causes +
         " cause it, equally in every repeat; it is not corrected and not part of any uncertainty.";
}

double uncorrected_bias_px(Comparison const& comparison) {
  std::vector<Vec2d> const& theory = comparison_kind(comparison).references.front().of(comparison);
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < comparison.mask.size(); ++i) {
    if (!comparison.mask[i]) continue;
    Vec2d const off = comparison.recorded().displacement_px[i] - theory[i];
    squares += dot(off, off);
    count += 2;
  }
  return std::sqrt(squares / count);
}

}  // namespace gladstone::inline compare
