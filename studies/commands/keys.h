#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/commands/setup_keys.h"

namespace gladstone::inline commands {

/// Keys of setups and studies that match a pattern.
struct FoundKeys {
  struct Key {
    SetupKeyTable const* table;
    SetupKey const* key;
  };
  std::vector<Key> keys;             ///< in the order of their tables
  std::vector<std::string> similar;  ///< if no key matches: paths of up to three similar keys
};

/// Finds the keys whose path contains the pattern, or matches it as a whole if it contains wildcards (*, ?, [...]).
FoundKeys find_keys(std::string const& pattern);

/// Returns an array of objects: key, condition, unit, default, values, meaning, ...
nlohmann::ordered_json keys_json(FoundKeys const& found);

}  // namespace gladstone::inline commands
