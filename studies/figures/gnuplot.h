#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/error.h"
#include "render/base/image.h"
#include "studies/passing_folder.h"

namespace gladstone {

/// The program gnuplot is not there: figures cannot be drawn, the numbers are not concerned.
class GnuplotMissing : public Error {
 public:
  GnuplotMissing()
      : Error(
            "figures are not drawn: program gnuplot not found (Debian package gnuplot-nox); the numbers "
            "are written all the same") {}
};

/// A figure in the making: commands and data for one run of gnuplot, in the house style (DejaVu Sans, UTF-8 text taken
/// literally). Data are stored in a temporary folder, removed with the object.
class GnuplotFigure {
 public:
  /// @param width_px,height_px of the picture
  GnuplotFigure(int width_px, int height_px);
  GnuplotFigure(GnuplotFigure const&) = delete;
  GnuplotFigure& operator=(GnuplotFigure const&) = delete;

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }

  /// Appends a line of gnuplot's language.
  void command(std::string_view line);

  /// Stores a map and returns its data source for `plot`: first node at (x_first, y_first), steps of either sign.
  std::string add_map(Image<double> const& map, double x_first, double x_step, double y_first, double y_step);

  /// Stores columns of equal length and returns their data source; columns are 1, 2, ... for `using`. NaN breaks lines.
  std::string add_table(std::vector<std::vector<double>> const& columns);

  /// Runs gnuplot and writes the picture as one whole file: SVG or PDF where the path ends so, else PNG.
  /// @throws GnuplotMissing; OutputError where the picture cannot be made or written
  void write(std::string const& path) const;

  /// Text as a gnuplot string.
  static std::string quoted(std::string_view text);
  /// Text of a tic as a gnuplot string: gnuplot takes it for a format of the tic's number.
  static std::string quoted_tic(std::string_view text);

 private:
  std::string store(std::span<double const> values);

  int width_px_;
  int height_px_;
  PassingFolder temporary_;
  std::string folder_;  ///< its path
  std::string script_;
  int files_ = 0;
};

/// The house's colours, for lines and bars: distinct for readers with a colour vision deficiency (Okabe & Ito 2008).
std::string_view house_colour(std::size_t index);

}  // namespace gladstone
