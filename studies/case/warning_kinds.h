#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "render/base/warning.h"

namespace gladstone::inline cases {

/// Summary of the warnings of many pairs: those with the same code and place are one kind.
class WarningKinds {
 public:
  /// @param pair   name of the pair
  /// @param place  place of the warning without the names that differ between pairs
  void add(std::string const& pair, Warning const& warning, std::string const& place);

  /// Returns the first warning of each kind, with its pair and the number of pairs.
  Warnings summary() const;

 private:
  struct Kind {
    Warning first;
    std::string last_pair;  ///< pair that was counted last
    std::size_t pairs;
  };
  std::vector<Kind> kinds_;
  std::map<std::pair<WarningCode, std::string>, std::size_t> index_;  ///< index in kinds_
};

}  // namespace gladstone::inline cases
