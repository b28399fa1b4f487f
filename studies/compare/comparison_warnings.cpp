#include "studies/compare/comparison_warnings.h"

#include <fmt/format.h>

#include "analysis/errors/error_summary.h"
#include "studies/case/peak_locking.h"
#include "studies/compare/comparison_kind.h"

namespace gladstone::inline compare {
namespace {

/// Returns a warning if the true displacements are too small to be measured; nullopt if not, or if all are zero.
std::optional<Warning> signal_warning(Comparison const& all, ComparisonKind const& kind) {
  std::vector<Vec2d> const nothing(all.mask.size());
  double const signal = summarize_errors(all.point.displacement_px, nothing, all.mask)["rms_px"];
  double const error =
      summarize_errors(all.measured.displacement_px, all.recorded().displacement_px, all.mask)["rms_px"];
  bool const small = signal < least_signal_px;
  if (signal == 0 || !(small || signal < error)) return {};
  return Warning{WarningCode::unreliable, "",
                 fmt::format("the true displacements are {:.2g} px rms per component, {}, and the error of the vectors "
                             "against {} is {:.2g} px: the vectors contain little information on the {}; increase {}",
                             signal, small ? fmt::format("below {:g} px", least_signal_px) : "less than the error",
                             all.recorded_name(), error, kind.measured, kind.remedy)};
}

}  // namespace

Warnings comparison_warnings(Comparison const& comparison, Setup const& setup) {
  Warnings warnings;
  for (auto const& warning : {signal_warning(comparison, comparison_kind(setup)), locking_advice(setup)}) {
    if (warning) warnings.push_back(*warning);
  }
  return warnings;
}

}  // namespace gladstone::inline compare
