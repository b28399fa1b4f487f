#pragma once

#include <string>

#include "studies/commands/description.h"

namespace gladstone::inline commands {

/// Describes a density, refractive-index or velocity field: nodes, units, extent, extremes and steepest gradient
/// (velocity: of each component).
/// @param dataset  name within the file; empty: the only data set
/// @param axes     world axes in the order of the file, the slowest first; empty: the file's own
/// @param setup    path of a setup whose view the field should cover; empty: none
/// @param figure   file of a figure of the three planes through the middle; empty: none
/// @throws DataError if the field cannot be read; OutputError if the figure cannot be written
Description describe_field(std::string const& path, std::string const& dataset, std::string const& axes,
                           std::string const& setup, std::string const& figure = "");

}  // namespace gladstone::inline commands
