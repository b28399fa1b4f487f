#include "analysis/vectors/vector_readers/vector_readers.h"

namespace gladstone::inline vectors {

bool is_openpiv(TextTable const& table) {
  return table.find({"x"}) && table.find({"y"}) && table.find({"u"}) && table.find({"v"}) &&
         table.find({"flags", "flag", "mask"});
}

VectorFile read_openpiv(TextTable const& table) {
  VectorFile file = read_quantities(table, "OpenPIV", {"flags", "flag", "mask"});
  DisplacementField& field = file.field;
  auto const flags = table.find({"flags", "flag"});
  auto const mask = table.find({"mask"});
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (flags && field.status[i] == VectorStatus::valid) {
      double const flag = table.values[*flags][i];
      if (flag != 0.0) field.status[i] = flag == 2.0 ? VectorStatus::replaced : VectorStatus::invalid;
    }
    if (mask && table.values[*mask][i] != 0.0) {
      // in files without flags, the column mask denotes invalid vectors
      field.status[i] = flags ? VectorStatus::masked : VectorStatus::invalid;
    }
  }
  // The vectors are stored either as measured or flipped by transform_coordinates. The position x = ws/2 is exact for
  // several passes; for a single pass, the window's centre is at (ws - 1)/2, half a pixel away.
  file.conventions.offset_px = -0.5;
  VectorConventions turned = file.conventions;
  turned.y_up = turned.v_up = true;
  file.also = {turned};
  add_offsets(file, {0.0});
  return file;
}

}  // namespace gladstone::inline vectors
