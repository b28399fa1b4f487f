#pragma once

#include <array>
#include <optional>
#include <string>

#include "render/files/fields/readers/array_coordinates.h"

namespace gladstone::inline files {

/// Order of the axes of an array, and how it was determined.
struct ArrayOrder {
  std::string letters;   ///< world axes, slowest first: "zyx"
  std::string by;        ///< source of the order, for messages: "by the lengths of its coordinates"
  bool several = false;  ///< true: the coordinates allow other orders as well
};

/// Determines the order of the axes by the lengths of the coordinates: z, y, x if they allow it, else the only order
/// that they allow. A two-dimensional array spans x and y unless one of these has no coordinates while z has.
/// @param of_letter  coordinates along x, y and z, as far as there are any
/// @param path,name  file and array, for errors
/// @throws DataError if several orders other than z, y, x are possible
ArrayOrder order_by_lengths(std::array<std::optional<ArrayCoordinates>, 3> const& of_letter, ArrayAxes const& axes,
                            std::string const& path, std::string const& name);

}  // namespace gladstone::inline files
