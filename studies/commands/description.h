#pragma once

#include <string>
#include <vector>

#include "studies/case/result_rows.h"

namespace gladstone::inline commands {

/// Result of `gladstone info`.
struct Description {
  std::string json;  ///< one JSON object
  std::string text;
  std::vector<ResultRow> rows = {};  ///< quantities for --csv; empty: the results are no list of quantities
};

}  // namespace gladstone::inline commands
