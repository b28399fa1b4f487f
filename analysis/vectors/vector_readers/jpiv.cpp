#include "analysis/vectors/vector_readers/vector_readers.h"

namespace gladstone::inline vectors {

bool is_jpiv(TextTable const& table) { return !table.has_header; }

VectorFile read_jpiv(TextTable const& table) {
  VectorFile file = read_quantities(table, "JPIV", {"quality"});
  add_offsets(file, {-0.5, -1.0, -1.5});
  auto const quality = table.find({"quality"});
  for (std::size_t i = 0; quality && i < file.field.size(); ++i) {
    if (table.values[*quality][i] < 0.0) file.field.status[i] = VectorStatus::invalid;
  }
  return file;
}

}  // namespace gladstone::inline vectors
