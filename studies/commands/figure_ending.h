#pragma once

#include <string>

namespace gladstone::inline commands {

/// Rejects the name of a new file without the ending of a figure (.png, .svg or .pdf). Whether an existing file may be
/// replaced is checked when it is opened.
/// @param figure  empty: no figure is drawn
/// @throws OutputError
void check_figure_ending(std::string const& figure);

}  // namespace gladstone::inline commands
