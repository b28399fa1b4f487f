#include "studies/compare/comparison_kind.h"

namespace gladstone::inline compare {

ComparisonKind const& comparison_kind(Setup const& setup) {
  ComparisonKind const* const kind = find_kind(all_comparison_kinds, setup.experiment());
  return kind ? *kind : *all_comparison_kinds.front();
}

ComparisonKind const& comparison_kind(Comparison const& comparison) {
  for (ComparisonKind const* one : all_comparison_kinds)
    if (one->chain == comparison.chain) return *one;
  return *all_comparison_kinds.front();
}

}  // namespace gladstone::inline compare
