#include "studies/figures/comparison_figures.h"

#include <cmath>

#include "studies/compare/comparison_kind.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/error_figures.h"
#include "studies/figures/map_figures.h"

namespace gladstone {

std::vector<std::string> draw_comparison(std::string const& folder, Comparison const& comparison,
                                         std::string const& format) {
  DisplacementField const& measured = comparison.measured;
  ComparisonKind const& kind = comparison_kind(comparison);
  std::vector<std::string> drawn;
  auto const next = [&](char const* name) { return drawn.emplace_back(folder + '/' + name + '.' + format); };
  auto const difference = [&](std::vector<Vec2d> const& from) {
    std::vector<Vec2d> error(measured.size());
    for (std::size_t i = 0; i < error.size(); ++i) {
      error[i] = comparison.mask[i] ? measured.displacement_px[i] - from[i] : Vec2d{std::nan(""), std::nan("")};
    }
    return error;
  };
  if (measured.columns > 1 && measured.rows > 1) {
    auto const maps = [&](std::string name, std::vector<Vec2d> const& values) {
      NamedMaps both{std::move(name), Image<double>(measured.columns, measured.rows),
                     Image<double>(measured.columns, measured.rows)};
      for (std::size_t i = 0; i < values.size(); ++i) {
        both.u_px.data()[i] = values[i].x;
        both.v_px.data()[i] = values[i].y;
      }
      return both;
    };
    MapAxes axes;
    axes.x_first = measured.position_px.front().x;
    axes.x_step = measured.position_px[1].x - axes.x_first;
    axes.y_first = measured.position_px.front().y;
    axes.y_step = measured.position_px[static_cast<std::size_t>(measured.columns)].y - axes.y_first;
    std::vector<NamedMaps> drawings{maps("ray truth", comparison.point.displacement_px)};
    for (ReferenceDisplacement const& one : kind.references) drawings.push_back(maps(one.name, one.of(comparison)));
    drawings.push_back(maps("measurement", measured.displacement_px));
    draw_figure(make_displacement_maps("Displacement, and differences from ray truth", axes, drawings),
                next("displacement_maps"));
  }
  std::vector<ErrorSeries> series{{"against ray truth", difference(comparison.point.displacement_px)}};
  for (ReferenceDisplacement const& one : kind.references)
    series.push_back({one.against, difference(one.of(comparison))});
  draw_figure(make_error_histograms("Measurement error", series), next("error_histograms"));
  if (measured.columns > 1 && measured.rows > 1) {
    DisplacementField truth = measured;
    truth.displacement_px = comparison.point.displacement_px;
    draw_figure(make_error_against_gradient("Measurement error against the local gradient", truth, series),
                next("error_against_gradient"));
  }
  draw_figure(make_budget_bars(std::string("Error budget, from ") + kind.origin + " to the measurement",
                               comparison.shown_budget()),
              next("error_budget"));
  return drawn;
}

}  // namespace gladstone
