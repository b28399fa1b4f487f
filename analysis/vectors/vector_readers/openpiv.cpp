#include "analysis/vectors/vector_readers/vector_readers.h"

namespace gladstone::detail {

bool is_openpiv(TextTable const& table) {
  return table.find({"x"}) && table.find({"y"}) && table.find({"u"}) && table.find({"v"}) &&
         table.find({"flags", "flag", "mask"});
}

VectorFile read_openpiv(TextTable const& table) {
  DisplacementField field =
      plain_vectors(table.column({"x"}), table.column({"y"}), table.column({"u"}), table.column({"v"}));
  auto const flags = table.find({"flags", "flag"});
  auto const mask = table.find({"mask"});
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (flags && field.status[i] == VectorStatus::valid) {
      double const flag = table.values[*flags][i];
      if (flag != 0.0) field.status[i] = flag == 2.0 ? VectorStatus::replaced : VectorStatus::invalid;
    }
    if (mask && table.values[*mask][i] != 0.0) {
      field.status[i] = flags ? VectorStatus::masked : VectorStatus::invalid;  // without flags, mask marks the invalid
    }
  }
  VectorConventions conventions;
  conventions.offset_px = -0.5;  // ws/2 where the centre is (ws - 1)/2
  return {std::move(field), "OpenPIV", conventions, true};
}

}  // namespace gladstone::detail
