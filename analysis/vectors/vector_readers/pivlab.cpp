#include <fmt/format.h>

#include "analysis/vectors/vector_readers/vector_readers.h"
#include "render/base/error.h"

namespace gladstone::detail {

bool is_pivlab(TextTable const& table) {
  bool const announced = !table.preamble.empty() && table.preamble.front().find("PIVlab") != std::string::npos;
  return announced || table.find({"vector type [-]"}) || table.find({"u [px/frame]"});
}

VectorFile read_pivlab(TextTable const& table) {
  for (std::string_view const calibrated : {"x [m]", "y [m]", "u [m/s]", "v [m/s]", "u [m/frame]", "v [m/frame]"}) {
    if (!table.find({calibrated})) continue;
    throw DataError(fmt::format("{}:{}", table.path, table.header_line),
                    fmt::format("column {} is calibrated, vectors are compared in px; clear the calibration in PIVlab "
                                "and export again in px and px/frame",
                                calibrated));
  }
  DisplacementField field = plain_vectors(table.column({"x [px]"}), table.column({"y [px]"}),
                                          table.column({"u [px/frame]"}), table.column({"v [px/frame]"}));
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
  VectorConventions conventions;
  conventions.offset_px = -1.5;  // first pixel is 1, and ws/2 where the centre is (ws - 1)/2
  return {std::move(field), "PIVlab", conventions, true};
}

}  // namespace gladstone::detail
