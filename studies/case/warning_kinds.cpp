#include "studies/case/warning_kinds.h"

#include <fmt/format.h>

namespace gladstone::inline cases {

void WarningKinds::add(std::string const& pair, Warning const& warning, std::string const& place) {
  auto const [known, is_new] = index_.try_emplace({warning.code, place}, kinds_.size());
  if (is_new) kinds_.push_back({at_place(pair, warning), "", 0});
  Kind& kind = kinds_[known->second];
  if (is_new || kind.last_pair != pair) ++kind.pairs;
  kind.last_pair = pair;
}

Warnings WarningKinds::summary() const {
  Warnings warnings;
  for (Kind const& kind : kinds_) {
    warnings.push_back(kind.first);
    if (kind.pairs > 1) warnings.back().text += fmt::format(" (and so on, {} pairs in total)", kind.pairs);
  }
  return warnings;
}

}  // namespace gladstone::inline cases
