#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace gladstone {

/// Keys of setups and studies that match a pattern.
struct FoundKeys {
  nlohmann::ordered_json keys;       ///< array of objects: key, condition, unit, default, values, meaning, ...
  std::string text;                  ///< two lines for each key
  std::vector<std::string> similar;  ///< if no key matches: paths of up to three similar keys
};

/// Finds the keys whose path contains the pattern, or matches it as a whole if it contains wildcards (*, ?, [...]).
FoundKeys find_keys(std::string const& pattern);

}  // namespace gladstone
