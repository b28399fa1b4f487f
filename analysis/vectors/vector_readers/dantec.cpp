#include <algorithm>

#include "analysis/vectors/vector_readers/vector_readers.h"

namespace gladstone::inline vectors {

bool is_dantec(TextTable const& table) {
  return std::any_of(table.preamble.begin(), table.preamble.end(),
                     [](std::string const& line) { return line.find(">>*DATA*<<") != std::string::npos; });
}

VectorFile read_dantec(TextTable const& table) {
  VectorFile file = read_quantities(table, "Dantec", {"status"});
  file.conventions.y_up = file.conventions.v_up = true;
  file.conventions.mirror = VectorConventions::Mirror::image;
  add_offsets(file, {-0.5, -1.0, -1.5});
  auto const codes = table.find({"status"});
  for (std::size_t i = 0; codes && i < file.field.size(); ++i) {
    constexpr double substituted = 16.0;
    double const code = table.values[*codes][i];
    if (code == 0.0 || file.field.status[i] != VectorStatus::valid) continue;
    file.field.status[i] = code == substituted ? VectorStatus::replaced : VectorStatus::invalid;
  }
  return file;
}

}  // namespace gladstone::inline vectors
