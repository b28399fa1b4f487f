#include "studies/figures/stereo_figure.h"

#include <functional>

#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "studies/figures/map_panels.h"

namespace gladstone::inline figures {
namespace {

/// Converts values of the nodes, in rows upwards, to a map with rows downwards.
Image<double> make_node_map(stereo::NodeGrid const& grid, std::function<double(std::size_t)> const& value) {
  Image<double> map(grid.columns, grid.rows);
  for (std::size_t node = 0; node < grid.size(); ++node) {
    auto const columns = static_cast<std::size_t>(grid.columns);
    map(static_cast<int>(node % columns), grid.rows - 1 - static_cast<int>(node / columns)) = value(node);
  }
  return map;
}

bool is_valid(std::optional<stereo::StereoVector> const& node) { return node && node->status == VectorStatus::valid; }

}  // namespace

Figure make_stereo_figure(StereoMeasurement const& measurement) {
  constexpr char const* names[] = {"u", "v", "w"};
  stereo::StereoField const& field = measurement.field;
  stereo::NodeGrid const& grid = field.grid;
  MapFigure figure;
  figure.title = "Displacement in three components";
  double const top = grid.first.y + grid.spacing * (grid.rows - 1), step_mm = grid.spacing / unit::mm;
  figure.axes = {grid.first.x / unit::mm, step_mm, top / unit::mm, -step_mm, false, "x [mm]", "y [mm]"};
  for (int axis = 0; axis < 3; ++axis)
    figure.panels.push_back({std::string(names[axis]) + " [mm]",
                             make_node_map(grid,
                                           [&](std::size_t node) {
                                             auto const& vector = field.nodes[node];
                                             return is_valid(vector) ? vector->displacement[axis] / unit::mm
                                                                     : not_a_number;
                                           }),
                             ColourScale::sequential});
  if (!measurement.truth.empty())
    for (int axis = 0; axis < 3; ++axis)
      figure.panels.push_back({std::string("error of ") + names[axis] + " [px]",
                               make_node_map(grid,
                                             [&](std::size_t node) {
                                               auto const& vector = field.nodes[node];
                                               return is_valid(vector) ? (vector->displacement[axis] -
                                                                          measurement.truth[node][axis]) /
                                                                             measurement.pixel_size
                                                                       : not_a_number;
                                             }),
                               ColourScale::diverging, "error"});
  figure.panels.push_back({"residual of the four equations [px]",
                           make_node_map(grid,
                                         [&](std::size_t node) {
                                           auto const& vector = field.nodes[node];
                                           return vector ? vector->residual_px : not_a_number;
                                         }),
                           ColourScale::magnitude});
  figure.columns = 3;
  return make_map_figure(figure);
}

}  // namespace gladstone::inline figures
