#pragma once

#include <limits>
#include <string>
#include <vector>

#include "render/base/image.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Coordinates of a map's nodes: first + step times index. Rows run downwards on the sensor: y_step > 0 with y_down for
/// pixels, y_step < 0 without y_down for world coordinates.
struct MapAxes {
  double x_first = 0.0, x_step = 1.0;
  double y_first = 0.0, y_step = 1.0;
  bool y_down = true;  ///< true if the axis points downwards, like the rows
  std::string x_label = "x [px]";
  std::string y_label = "y [px]";
};

enum class ColourScale {
  diverging,   ///< blue - white - red, symmetric about zero: signed quantities
  sequential,  ///< viridis from the smallest to the largest value
  magnitude,   ///< viridis from zero: magnitudes and errors
  grey,        ///< black to white from zero: images
};

/// One map with title and colour bar. NaN is grey; values outside the range are clipped to its end colours.
struct MapPanel {
  std::string title;  ///< title with the unit, e.g. "u, ray truth [px]"
  Image<double> map;  ///< values of the map; empty: no panel is drawn at this position
  ColourScale scale = ColourScale::diverging;
  /// panels with the same name share a range; empty: separate range
  std::string range_group = {};
  double lower = std::numeric_limits<double>::quiet_NaN();  ///< ends of the colour scale; NaN: the 0.25 and 99.75 %
                                                            ///< quantiles of the values
  double upper = std::numeric_limits<double>::quiet_NaN();
};

/// Panels in rows on a grid of `columns`, with common axes.
struct MapFigure {
  std::string title = {};
  int columns = 2;
  MapAxes axes = {};
  std::vector<MapPanel> panels = {};
  std::vector<std::string> row_headings = {};  ///< above each row of panels; empty: no heading
};

/// Arranges the maps, with equal scales on both axes.
/// @pre a panel has a map
Figure make_map_figure(MapFigure const& maps);

/// Limits of a panel's colour scale.
struct ColourRange {
  double lower = 0.0;
  double upper = 1.0;
};

/// Returns the range between quantiles of the finite values, so that single outliers do not dominate; never empty.
ColourRange colour_range(Image<double> const& map, ColourScale scale);

}  // namespace gladstone::inline figures
