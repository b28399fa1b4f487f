#pragma once

#include <string>

namespace gladstone {

/// Result of `gladstone info`.
struct Description {
  std::string json;  ///< one JSON object
  std::string text;
};

}  // namespace gladstone
