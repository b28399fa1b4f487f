#include "studies/figures/comparison_figures.h"

#include <fmt/format.h>

#include <cmath>

#include "studies/compare/comparison_kind.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/error_figures.h"
#include "studies/figures/map_figures.h"

namespace gladstone::inline figures {

std::vector<NamedFigure> make_comparison_figures(Comparison const& comparison) {
  DisplacementField const& measured = comparison.measured;
  ComparisonKind const& kind = comparison_kind(comparison);
  bool const gridded = measured.columns > 1 && measured.rows > 1;
  std::vector<NamedMaps> maps;
  std::vector<ErrorSeries> series;
  auto const add_maps = [&](std::string name, std::vector<Vec2d> const& values) {
    if (gridded)
      maps.push_back(
          {std::move(name), component_map(measured, values, &Vec2d::x), component_map(measured, values, &Vec2d::y)});
  };
  auto const add_series = [&](std::string name, std::vector<Vec2d> const& from) {
    std::vector<Vec2d> error(measured.size(), Vec2d{std::nan(""), std::nan("")});
    for (std::size_t i = 0; i < error.size(); ++i)
      if (comparison.mask[i]) error[i] = measured.displacement_px[i] - from[i];
    series.push_back({std::move(name), std::move(error)});
  };
  add_maps("ray truth", comparison.point.displacement_px);
  add_series("against ray truth", comparison.point.displacement_px);
  for (ReferenceDisplacement const& one : kind.references) {
    add_maps(one.name, one.of(comparison));
    add_series(one.against, one.of(comparison));
  }
  add_maps("measurement", measured.displacement_px);

  std::vector<NamedFigure> figures;
  if (gridded)
    figures.push_back({"displacement_maps", make_displacement_maps("Displacement, and differences from ray truth",
                                                                   lattice_axes(measured), maps)});
  figures.push_back({"error_histograms", make_error_histograms("Measurement error", series)});
  if (gridded) {
    DisplacementField truth = measured;
    truth.displacement_px = comparison.point.displacement_px;
    figures.push_back({"error_against_gradient",
                       make_error_against_gradient("Measurement error against the local gradient", truth, series)});
  }
  figures.push_back(
      {"error_budget", make_budget_bars(std::string("Error budget, from ") + kind.origin + " to the measurement",
                                        comparison.shown_budget())});
  return figures;
}

std::vector<std::string> draw_comparison(std::string const& folder, Comparison const& comparison,
                                         std::string const& format) {
  std::vector<std::string> drawn;
  for (auto const& [name, figure] : make_comparison_figures(comparison)) {
    drawn.push_back(fmt::format("{}/{}.{}", folder, name, format));
    draw_figure(figure, drawn.back());
  }
  return drawn;
}

}  // namespace gladstone::inline figures
