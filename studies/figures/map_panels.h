#pragma once

#include <limits>
#include <string>
#include <vector>

#include "render/base/image.h"

namespace gladstone {

/// Where the nodes of a panel's map lie; node (column, row) at first + step times its indices.
/// Rows run downwards on the sensor: y_step > 0 with y_down for pixels, y_step < 0 without for world coordinates.
struct MapAxes {
  double x_first = 0.0, x_step = 1.0;
  double y_first = 0.0, y_step = 1.0;
  bool y_down = true;  ///< the axis points downwards, as rows do
  std::string x_label = "x [px]";
  std::string y_label = "y [px]";
};

enum class ColourScale {
  diverging,   ///< blue - white - red, symmetric about zero: signed quantities
  sequential,  ///< viridis from the smallest to the largest value
  magnitude,   ///< viridis from zero: magnitudes and errors
  grey,        ///< black to white from zero: pictures
};

/// One map with its title and colour bar. NaN is grey; values beyond the range take the colour at its end.
struct MapPanel {
  std::string title;  ///< with the unit: "u, ray truth [px]"
  Image<double> map;  ///< empty: the place stays empty
  ColourScale scale = ColourScale::diverging;
  std::string range_group = {};                             ///< panels of one name share their range; empty: its own
  double lower = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the 0.25 and 99.75 % quantiles of the values
  double upper = std::numeric_limits<double>::quiet_NaN();
};

/// Panels row by row on a grid of `columns`, all with the same axes.
struct MapFigure {
  std::string title = {};
  int columns = 2;
  MapAxes axes = {};
  std::vector<MapPanel> panels = {};
  std::vector<std::string> row_headings = {};  ///< above each row of panels where not empty
};

/// Draws the maps with equal scales on both axes and writes a PNG.
/// @throws GnuplotMissing, OutputError
void write_map_figure(std::string const& path, MapFigure const& figure);

/// The command that sets the palette of sequential maps.
char const* sequential_palette();

/// The range of colours that a panel takes by itself.
struct ColourRange {
  double lower = 0.0;
  double upper = 1.0;
};

/// From quantiles of the finite values, so that a few outliers do not bleach the map; never empty.
ColourRange colour_range(Image<double> const& map, ColourScale scale);

}  // namespace gladstone
