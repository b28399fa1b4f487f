#pragma once

#include <string>

#include "render/base/error.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline drawing {

/// Thrown if the program gnuplot is not installed. Only figures are affected.
class GnuplotMissing : public Error {
 public:
  GnuplotMissing()
      : Error(ErrorCode::output,
              "figures are not drawn: program gnuplot not found (Debian package gnuplot-nox); the numbers are written "
              "nevertheless") {}
};

/// Draws a figure with gnuplot and the templates, as SVG or PDF if the path ends accordingly, else as PNG; the file is
/// written atomically.
/// @throws GnuplotMissing if gnuplot is not installed
/// @throws OutputError if the figure cannot be created or written
void draw_figure(Figure const& figure, std::string const& path);

}  // namespace gladstone::inline drawing
