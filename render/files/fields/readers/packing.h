#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/files/fields/readers/array_file.h"

namespace gladstone::inline files {

/// Packing of an array: CF Conventions 1.11, sections 2.5.1 (missing data) and 8.1 (packed data).
struct Packing {
  double scale_factor = 1, add_offset = 0;
  std::vector<double> missing;  ///< stored values that mark missing data

  bool scaled() const { return scale_factor != 1 || add_offset != 0; }
  /// Converts stored values; missing ones become NaN.
  void unpack(std::span<double> values) const;
};

/// Reads the attributes scale_factor, add_offset, _FillValue and missing_value of an array.
Packing read_packing(ArrayFile const& file, std::string const& dataset);

}  // namespace gladstone::inline files
