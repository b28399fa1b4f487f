#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/image.h"
#include "studies/drawing/temporary_directory.h"

namespace gladstone::inline drawing {

/// Script and data for one run of gnuplot. They are stored in a temporary directory that is removed on destruction.
class GnuplotScript {
 public:
  GnuplotScript() : folder_(temporary_.path()) {}
  GnuplotScript(GnuplotScript const&) = delete;
  GnuplotScript& operator=(GnuplotScript const&) = delete;

  /// Appends a line.
  void command(std::string_view line);

  /// Stores a file, which commands can load.
  void add_file(std::string const& name, std::string_view bytes) const;

  /// Stores a map and returns its data source for `plot`: first node at (x_first, y_first), steps of either sign.
  std::string add_map(Image<double> const& map, double x_first, double x_step, double y_first, double y_step);

  /// Stores columns of equal length and returns their data source; `using` addresses them as 1, 2, ... NaN interrupts
  /// lines.
  std::string add_table(std::vector<std::vector<double>> const& columns);

  /// Runs gnuplot and writes the figure atomically, as SVG or PDF if the path ends accordingly, else as PNG.
  /// @param width_px   width of the page [px]
  /// @param height_px  height of the page [px]
  /// @param base_font  font of texts that have no other one, as a gnuplot string
  /// @throws GnuplotMissing if gnuplot is not installed
  /// @throws OutputError if the figure cannot be created or written
  void write(std::string const& path, int width_px, int height_px, std::string_view base_font) const;

  /// Returns text as a gnuplot string.
  static std::string quoted(std::string_view text);
  /// Returns the text of a tick as a gnuplot string, escaped because gnuplot interprets it as a format.
  static std::string quoted_tick(std::string_view text);

 private:
  std::string store(std::span<double const> values);

  TemporaryDirectory temporary_;
  std::string folder_;  ///< path of temporary_
  std::string script_;
  int files_ = 0;
};

}  // namespace gladstone::inline drawing
