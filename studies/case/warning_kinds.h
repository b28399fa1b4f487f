#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace gladstone {

/// Summary of the warnings of many pairs: those that differ only in their numbers are one kind.
class WarningKinds {
 public:
  /// @param pair     name of the pair
  /// @param warning  warning about the pair
  /// @param kind     the warning without the names that differ between pairs; its digits are ignored
  void add(std::string const& pair, std::string const& warning, std::string kind);

  /// Returns the first warning of each kind, with its pair and the number of pairs.
  std::vector<std::string> summary() const;

 private:
  std::vector<std::pair<std::string, std::size_t>> kinds_;  ///< first warning of a kind, and number of pairs
  std::map<std::string, std::size_t> index_;                ///< index in kinds_
};

}  // namespace gladstone
