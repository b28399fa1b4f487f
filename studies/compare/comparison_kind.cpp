#include "studies/compare/comparison_kind.h"

namespace gladstone::inline compare {

ComparisonKind const& comparison_kind(Setup const& setup) {
  for (ComparisonKind const* one : all_comparison_kinds)
    if (&one->experiment == &setup.experiment()) return *one;
  return *all_comparison_kinds.front();
}

ComparisonKind const& comparison_kind(Comparison const& comparison) {
  for (ComparisonKind const* one : all_comparison_kinds)
    if (one->chain == comparison.chain) return *one;
  return *all_comparison_kinds.front();
}

}  // namespace gladstone::inline compare
