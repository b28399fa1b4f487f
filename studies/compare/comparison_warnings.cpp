#include "studies/compare/comparison_warnings.h"

#include <fmt/format.h>

#include "analysis/errors/error_summary.h"
#include "studies/case/peak_locking.h"
#include "studies/compare/comparison_kind.h"

namespace gladstone {
namespace {

/// Returns a warning if the true displacements are too small to be measured; empty if not, or if all are zero.
std::string signal_warning(Comparison const& all, ComparisonKind const& kind) {
  std::vector<Vec2d> const nothing(all.mask.size());
  double const signal = summarize_errors(all.point.displacement_px, nothing, all.mask).rms_px;
  double const error = summarize_errors(all.measured.displacement_px, all.recorded().displacement_px, all.mask).rms_px;
  bool const small = signal < least_signal_px;
  if (signal == 0 || !(small || signal < error)) return {};
  return fmt::format(
      "the true displacements are {:.2g} px rms per component, {}, and the error of the vectors against {} is {:.2g} "
      "px: the vectors contain little information on the {}; increase {}",
      signal, small ? fmt::format("below {:g} px", least_signal_px) : "less than the error", all.recorded_name(), error,
      kind.measured, kind.remedy);
}

}  // namespace

std::vector<std::string> comparison_warnings(Comparison const& comparison, Setup const& setup) {
  std::vector<std::string> warnings;
  for (std::string& text : std::vector{signal_warning(comparison, comparison_kind(setup)), locking_advice(setup)}) {
    if (!text.empty()) warnings.push_back(std::move(text));
  }
  return warnings;
}

}  // namespace gladstone
