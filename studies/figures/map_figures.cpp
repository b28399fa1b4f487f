#include "studies/figures/map_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "render/base/contracts.h"

namespace gladstone::inline figures {
namespace {

Image<double> difference(Image<double> const& a, Image<double> const& b) {
  GLADSTONE_EXPECTS(a.columns() == b.columns() && a.rows() == b.rows());
  Image<double> result(a.columns(), a.rows());
  std::transform(a.begin(), a.end(), b.begin(), result.begin(), std::minus<>{});
  return result;
}

/// Returns the colour range of a component of the displacement: that of the first source, whose truth is free of noise
/// and without the large values of Eq. 9, and at least a fiftieth of the range of the other component. Otherwise noise
/// would saturate the map of a component that is nearly zero.
ColourRange component_range(Image<double> const& component, Image<double> const& other) {
  ColourRange range = colour_range(component, ColourScale::diverging);
  double const least = colour_range(other, ColourScale::diverging).upper / 50;
  range.upper = std::max(range.upper, least);
  range.lower = -range.upper;
  return range;
}

}  // namespace

MapAxes lattice_axes(DisplacementField const& field) {
  GLADSTONE_EXPECTS(field.columns > 1 && field.rows > 1);
  MapAxes axes;
  axes.x_first = field.position_px.front().x;
  axes.x_step = field.position_px[1].x - axes.x_first;
  axes.y_first = field.position_px.front().y;
  axes.y_step = field.position_px[static_cast<std::size_t>(field.columns)].y - axes.y_first;
  return axes;
}

Image<double> component_map(DisplacementField const& lattice, std::vector<Vec2d> const& values, double Vec2d::*part) {
  Image<double> map(lattice.columns, lattice.rows);
  std::transform(values.begin(), values.end(), map.begin(), [part](Vec2d const& value) { return value.*part; });
  return map;
}

Figure make_vector_maps(DisplacementField const& lattice, std::vector<Vec2d> const& values, std::string const& unit) {
  Image<double> u = component_map(lattice, values, &Vec2d::x), v = component_map(lattice, values, &Vec2d::y);
  Image<double> magnitude(lattice.columns, lattice.rows);
  std::transform(values.begin(), values.end(), magnitude.begin(), [](Vec2d const& value) { return length(value); });
  MapFigure figure{.columns = 3, .axes = lattice_axes(lattice)};
  figure.panels = {{fmt::format("magnitude [{}]", unit), std::move(magnitude), ColourScale::magnitude},
                   {fmt::format("u [{}]", unit), std::move(u)},
                   {fmt::format("v [{}]", unit), std::move(v)}};
  return make_map_figure(figure);
}

Figure make_displacement_maps(std::string const& title, MapAxes const& axes, std::vector<NamedMaps> const& sources) {
  GLADSTONE_EXPECTS(!sources.empty());
  MapFigure figure;
  figure.title = title;
  figure.axes = axes;
  figure.columns = static_cast<int>(sources.size());
  auto const add_row = [&](char const* component, Image<double> NamedMaps::*map, Image<double> NamedMaps::*other) {
    ColourRange const range = component_range(sources.front().*map, sources.front().*other);
    for (NamedMaps const& source : sources) {
      figure.panels.push_back({fmt::format("{}, {} [px]", component, source.name), source.*map, ColourScale::diverging,
                               "", range.lower, range.upper});
    }
  };
  auto const add_differences = [&](char const* component, Image<double> NamedMaps::*map) {
    NamedMaps const& reference = sources.front();
    figure.panels.push_back({});
    for (std::size_t i = 1; i < sources.size(); ++i) {
      figure.panels.push_back({fmt::format("Δ{}, {} − {} [px]", component, sources[i].name, reference.name),
                               difference(sources[i].*map, reference.*map), ColourScale::diverging,
                               "difference of " + sources[i].name});
    }
  };
  add_row("u", &NamedMaps::u_px, &NamedMaps::v_px);
  add_row("v", &NamedMaps::v_px, &NamedMaps::u_px);
  if (sources.size() > 1) {
    add_differences("u", &NamedMaps::u_px);
    add_differences("v", &NamedMaps::v_px);
  }
  return make_map_figure(figure);
}

Figure make_seed_figure4(MapAxes const& axes, std::vector<SeedFigure4Instant> const& instants) {
  GLADSTONE_EXPECTS(!instants.empty());
  MapFigure figure;
  figure.axes = axes;
  figure.columns = 5;
  for (SeedFigure4Instant const& instant : instants) {
    Image<double> magnitude(instant.gradient_x.columns(), instant.gradient_x.rows());
    std::transform(instant.gradient_x.begin(), instant.gradient_x.end(), instant.gradient_y.begin(), magnitude.begin(),
                   [](double x, double y) { return std::hypot(x, y); });
    std::string const gradient = "gradient of " + instant.heading, displacement = "displacement of " + instant.heading;
    auto const add_displacements = [&](char const* component, Image<double> NamedMaps::*map) {
      for (NamedMaps const& source : {instant.theory, instant.cone, instant.rays}) {
        figure.panels.push_back(
            {fmt::format("Δ{}, {} [px]", component, source.name), source.*map, ColourScale::diverging, displacement});
      }
    };
    figure.panels.push_back({"ρ [kg/m³]", instant.density, ColourScale::sequential});
    figure.panels.push_back({"∂ρ/∂x [kg/m⁴]", instant.gradient_x, ColourScale::diverging, gradient});
    add_displacements("x", &NamedMaps::u_px);
    figure.panels.push_back({"|∇ρ| [kg/m⁴]", std::move(magnitude), ColourScale::magnitude});
    figure.panels.push_back({"∂ρ/∂y [kg/m⁴]", instant.gradient_y, ColourScale::diverging, gradient});
    add_displacements("y", &NamedMaps::v_px);
    figure.row_headings.push_back(instant.heading + "  (one colour range for its six displacements)");
    figure.row_headings.emplace_back();
  }
  return make_map_figure(figure);
}

}  // namespace gladstone::inline figures
