#include "render/files/fields/readers/packing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gladstone::inline files {

void Packing::unpack(std::span<double> values) const {
  // compared as float, since an attribute may have fewer digits than its data
  auto const is_missing = [this](double value) {
    return std::any_of(missing.begin(), missing.end(), [value](double mark) {
      return value == mark || (static_cast<float>(value) == static_cast<float>(mark) && std::isfinite(mark));
    });
  };
  for (double& value : values) {
    value = is_missing(value) ? std::numeric_limits<double>::quiet_NaN() : value * scale_factor + add_offset;
  }
}

Packing read_packing(ArrayFile const& file, std::string const& dataset) {
  Packing packing;
  auto const scale = file.number_attribute(dataset, "scale_factor");
  auto const offset = file.number_attribute(dataset, "add_offset");
  if (scale.size() == 1) packing.scale_factor = scale.front();
  if (offset.size() == 1) packing.add_offset = offset.front();
  for (char const* const name : {"_FillValue", "missing_value"}) {
    auto const marks = file.number_attribute(dataset, name);
    packing.missing.insert(packing.missing.end(), marks.begin(), marks.end());
  }
  return packing;
}

}  // namespace gladstone::inline files
