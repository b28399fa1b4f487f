#include <fmt/format.h>

#include <algorithm>

#include "analysis/vectors/vector_readers/vector_readers.h"

namespace gladstone::inline vectors {
namespace {

/// Masks vectors of exactly zero: DaVis writes removed or masked vectors as zeros.
void mask_zeros(VectorFile& file, std::string const& path) {
  std::size_t masked = 0;
  for (std::size_t i = 0; i < file.field.size(); ++i) {
    if (!(file.field.displacement_px[i] == Vec2d{})) continue;
    file.field.status[i] = VectorStatus::masked;
    ++masked;
  }
  if (masked == 0) return;
  file.warnings.push_back({WarningCode::assumed, path,
                           fmt::format("{} of {} vectors are exactly zero and count as masked, since DaVis writes "
                                       "masked vectors like this; export the column isValid to mark them",
                                       masked, file.field.size())});
}

/// Returns true if y increases from the first row of vectors to the next. DaVis' text export begins with the top row,
/// so that y points downwards in this case (Moisy, PIVMat, loadpivtxt.m).
bool begins_with_smaller_y(DisplacementField const& field) {
  auto const next = std::find_if(field.position_px.begin(), field.position_px.end(),
                                 [&](Vec2d const& p) { return p.y != field.position_px.front().y; });
  return next != field.position_px.end() && next->y > field.position_px.front().y;
}

}  // namespace

bool is_tecplot(TextTable const& table) { return table.tecplot || table.davis; }

VectorFile read_tecplot(TextTable const& table) {
  std::string const format = table.find({"chc"}) ? "Insight" : table.find_quantity({"vx"}) ? "DaVis" : "Tecplot";
  VectorFile file = read_quantities(table, format, {"chc", "isvalid", "valid", "is valid"});
  VectorConventions upwards;
  upwards.y_up = upwards.v_up = true;
  upwards.mirror = VectorConventions::Mirror::image;
  if (!table.davis || !begins_with_smaller_y(file.field)) file.conventions = upwards;
  add_offsets(file, {-0.5, -1.0, -1.5});
  if (!read_validity(table, file.field)) mask_zeros(file, table.path);
  return file;
}

}  // namespace gladstone::inline vectors
