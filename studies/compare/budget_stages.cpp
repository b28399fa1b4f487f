#include "studies/compare/budget_stages.h"

#include <algorithm>
#include <cmath>

#include "studies/compare/comparison_kind.h"

namespace gladstone::inline compare {

std::vector<BudgetStage> budget_stages(Comparison const& comparison, WindowTruth const& window) {
  std::vector<BudgetStage> stages{{"window", window.displacement_px},
                                  {"noise_free", comparison.noise_free},
                                  {"measured", comparison.measured.displacement_px}};
  std::vector<BudgetStage> const to_truth = comparison_kind(comparison).stages(comparison);
  stages.insert(stages.end(), to_truth.begin(), to_truth.end());
  return stages;
}

std::vector<BudgetStage> budget_differences(Comparison const& comparison) {
  std::vector<BudgetStage> const stages = budget_stages(comparison, comparison.recorded());
  std::vector<std::string_view> const chain = budget_stage_names(comparison.chain),
                                      terms = budget_term_names(comparison.chain);
  std::vector<BudgetStage> differences;
  BudgetStage const* before = nullptr;
  std::size_t first_term = 0;  // index of the first error source behind the stage `before` in the full chain
  for (std::size_t i = 0; i < chain.size(); ++i) {
    auto const here = std::find_if(stages.begin(), stages.end(), [&](BudgetStage const& stage) {
      return stage.name == chain[i] && !stage.displacement_px.empty();
    });
    if (here == stages.end()) continue;
    if (before) {
      BudgetStage& added = differences.emplace_back();
      added.name = terms[first_term];
      added.displacement_px.assign(comparison.mask.size(), Vec2d{std::nan(""), std::nan("")});
      for (std::size_t k = 0; k < comparison.mask.size(); ++k) {
        if (comparison.mask[k]) added.displacement_px[k] = here->displacement_px[k] - before->displacement_px[k];
      }
    }
    before = &*here;
    first_term = i;
  }
  return differences;
}

}  // namespace gladstone::inline compare
