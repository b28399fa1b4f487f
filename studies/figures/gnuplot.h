#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/error.h"
#include "render/base/image.h"
#include "studies/figures/temporary_directory.h"

namespace gladstone {

/// Thrown if the program gnuplot is not installed. Only figures are affected.
class GnuplotMissing : public Error {
 public:
  GnuplotMissing()
      : Error(ErrorCode::output,
              "figures are not drawn: program gnuplot not found (Debian package gnuplot-nox); the numbers are written "
              "nevertheless") {}
};

/// Calls a function that draws figures; without gnuplot, warns that they are not drawn.
/// @return false without gnuplot
bool draw_or_warn(std::function<void()> const& draw);

/// Builder of a figure: commands and data for one run of gnuplot, in a common style (DejaVu Sans, UTF-8 text taken
/// literally). Data are stored in a temporary directory that is removed on destruction.
class GnuplotFigure {
 public:
  /// @param width_px   width of the figure [px]
  /// @param height_px  height of the figure [px]
  GnuplotFigure(int width_px, int height_px);
  GnuplotFigure(GnuplotFigure const&) = delete;
  GnuplotFigure& operator=(GnuplotFigure const&) = delete;

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }

  /// Appends a line to the gnuplot script.
  void command(std::string_view line);
  /// Sets the margins of the next plot [px], from the figure's upper left corner.
  void set_margins(double left, double right, double top, double bottom);

  /// Stores a map and returns its data source for `plot`: first node at (x_first, y_first), steps of either sign.
  std::string add_map(Image<double> const& map, double x_first, double x_step, double y_first, double y_step);

  /// Stores columns of equal length and returns their data source; `using` addresses them as 1, 2, ... NaN interrupts
  /// lines.
  std::string add_table(std::vector<std::vector<double>> const& columns);

  /// Runs gnuplot and writes the figure atomically, as SVG or PDF if the path ends accordingly, else as PNG.
  /// @throws GnuplotMissing if gnuplot is not installed
  /// @throws OutputError if the figure cannot be created or written
  void write(std::string const& path) const;

  /// Returns text as a gnuplot string.
  static std::string quoted(std::string_view text);
  /// Returns the text of a tic label as a gnuplot string, escaped because gnuplot interprets it as a format.
  static std::string quoted_tic(std::string_view text);

 private:
  std::string store(std::span<double const> values);

  int width_px_;
  int height_px_;
  TemporaryDirectory temporary_;
  std::string folder_;  ///< path of temporary_
  std::string script_;
  int files_ = 0;
};

/// Returns a colour for lines and bars, distinguishable with a colour vision deficiency (Okabe & Ito 2008).
std::string_view house_colour(std::size_t index);

}  // namespace gladstone
