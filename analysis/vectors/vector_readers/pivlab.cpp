#include "analysis/vectors/vector_readers/vector_readers.h"

namespace gladstone::inline vectors {

bool is_pivlab(TextTable const& table) {
  bool const announced = !table.preamble.empty() && table.preamble.front().find("PIVlab") != std::string::npos;
  return announced || table.find({"vector type [-]"}) || table.find({"u [px/frame]"});
}

VectorFile read_pivlab(TextTable const& table) {
  VectorFile file = read_quantities(table, "PIVlab", {"vector type [-]"});
  DisplacementField& field = file.field;
  if (auto const type = table.find({"vector type [-]"})) {
    for (std::size_t i = 0; i < field.size(); ++i) {
      double const value = table.values[*type][i];
      if (value == 0.0) {
        field.status[i] = VectorStatus::masked;
      } else if (value != 1.0 && field.status[i] == VectorStatus::valid) {
        field.status[i] = VectorStatus::replaced;
      }
    }
  }
  // positions count from 1, and the centre of a window is at ws/2 instead of (ws - 1)/2
  if (file.place_unit.empty()) file.conventions.offset_px = -1.5;
  add_offsets(file, {-1.0, -0.5, 0.0});
  return file;
}

}  // namespace gladstone::inline vectors
