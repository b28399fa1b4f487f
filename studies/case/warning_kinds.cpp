#include "studies/case/warning_kinds.h"

#include <fmt/format.h>

namespace gladstone {

void WarningKinds::add(std::string const& pair, std::string const& warning, std::string kind) {
  std::erase_if(kind, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
  auto const [known, is_new] = index_.emplace(std::move(kind), kinds_.size());
  if (is_new) kinds_.emplace_back(pair + ": " + warning, 0);
  ++kinds_[known->second].second;
}

std::vector<std::string> WarningKinds::summary() const {
  std::vector<std::string> texts;
  for (auto const& [text, count] : kinds_)
    texts.push_back(count == 1 ? text : fmt::format("{} (and so on, {} pairs in total)", text, count));
  return texts;
}

}  // namespace gladstone
