#pragma once

#include <string>

#include "render/files/fields/readers/array_file.h"

namespace gladstone::inline files {

/// Returns the only dataset that can be the field, for use if the user names none; among several a density of
/// gladstone, which contains also its uncertainty.
/// @param values  number of values per node: 1, or 3 for a velocity
/// @throws DataError if there is none, or several
std::string only_field(ArrayFile const& file, std::string const& path, int values);

}  // namespace gladstone::inline files
