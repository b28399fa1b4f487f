#include "studies/figures/error_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/contracts.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;

std::vector<double> component(std::vector<Vec2d> const& values, double Vec2d::*part) {
  std::vector<double> result;
  for (Vec2d const& value : values) {
    if (is_finite(value)) result.push_back(value.*part);
  }
  return result;
}

/// Returns the outline of a histogram: probability density [1/px] over bins of equal width on [-reach, reach].
std::vector<std::vector<double>> density_of(std::vector<double> const& errors, double reach, int bins) {
  std::vector<double> count(static_cast<std::size_t>(bins), 0.0);
  double const width = 2.0 * reach / bins;
  for (double const e : errors) {
    auto const bin = static_cast<int>(std::floor((e + reach) / width));
    if (bin >= 0 && bin < bins) count[static_cast<std::size_t>(bin)] += 1.0;
  }
  std::vector<std::vector<double>> outline(2);
  for (int bin = 0; bin < bins; ++bin) {
    double const density = count[static_cast<std::size_t>(bin)] / (width * static_cast<double>(errors.size()));
    for (int const edge : {bin, bin + 1}) {
      outline[0].push_back(-reach + edge * width);
      outline[1].push_back(density);
    }
  }
  return outline;
}

/// Returns the largest error of an axis: the 99 % quantile of the widest series, but at most 8 times that of the
/// narrowest.
double histogram_reach(std::vector<ErrorSeries> const& series) {
  double widest = 0.0;
  double narrowest = std::numeric_limits<double>::infinity();
  for (ErrorSeries const& one : series) {
    for (double Vec2d::*part : {&Vec2d::x, &Vec2d::y}) {
      std::vector<double> magnitude = component(one.error_px, part);
      for (double& value : magnitude) value = std::abs(value);
      double const wide = quantile(std::move(magnitude), 0.99);
      if (!(wide > 0.0)) continue;
      widest = std::max(widest, wide);
      narrowest = std::min(narrowest, wide);
    }
  }
  return widest > 0.0 ? std::min(widest, 8.0 * narrowest) : 1e-3;
}

/// Median and band of the errors in bins of equal count of the gradient.
struct BinnedErrors {
  std::vector<double> gradient, median, low, high;
};

BinnedErrors bin_errors(std::vector<double> const& gradient, std::vector<Vec2d> const& error_px) {
  GLADSTONE_EXPECTS(error_px.size() == gradient.size());
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    if (std::isfinite(gradient[i]) && is_finite(error_px[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return gradient[a] < gradient[b]; });
  // Use bins with at least 20 vectors each if there are enough vectors.
  std::size_t const bins = std::clamp<std::size_t>(order.size() / 20, 1, 15);
  BinnedErrors binned;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    std::vector<double> place_of, magnitude;
    for (std::size_t k = bin * order.size() / bins; k < (bin + 1) * order.size() / bins; ++k) {
      place_of.push_back(gradient[order[k]]);
      magnitude.push_back(std::max(length(error_px[order[k]]), 1e-15));  // positive for the logarithmic axis
    }
    if (magnitude.empty()) continue;
    binned.gradient.push_back(quantile(place_of, 0.5));
    binned.median.push_back(quantile(magnitude, 0.5));
    binned.low.push_back(quantile(magnitude, 0.1));
    binned.high.push_back(quantile(magnitude, 0.9));
  }
  return binned;
}

}  // namespace

Figure make_error_histograms(std::string const& title, std::vector<ErrorSeries> const& series) {
  GLADSTONE_EXPECTS(!series.empty());
  double const reach = histogram_reach(series);
  int const legend = 22 * static_cast<int>(series.size()) + 10;
  Figure figure{1200, 430 + legend};
  figure.add_title(title);
  for (bool const is_u : {true, false}) {
    Panel panel{.box = {is_u ? 80.0 : 680, is_u ? 570.0 : 1170, 50.0 + legend, figure.height_px - 58.0}};
    panel.x = {is_u ? "error of u [px]" : "error of v [px]", -reach, reach};
    panel.y = {.label = "probability density [1/px]", .low = 0};
    panel.grid = Grid::both;
    panel.legend.place = LegendPlace::above;
    std::vector<Layer> lines;
    for (std::size_t i = 0; i < series.size(); ++i) {
      std::vector<double> const errors = component(series[i].error_px, is_u ? &Vec2d::x : &Vec2d::y);
      ErrorSummary const summary =
          summarize_errors(series[i].error_px, std::vector<Vec2d>(series[i].error_px.size()), {});
      std::string const label = errors.empty() ? fmt::format("{}: no vectors", series[i].name)
                                               : fmt::format("{}: bias {:+.4f}, random {:.4f} px", series[i].name,
                                                             is_u ? summary["bias_u_px"] : summary["bias_v_px"],
                                                             is_u ? summary["random_u_px"] : summary["random_v_px"]);
      std::vector<std::vector<double>> const outline = density_of(errors, reach, 81);
      std::vector<double> const zero(outline[0].size(), 0.0);
      panel.layers.push_back({Layer::Kind::band, {outline[0], zero, outline[1]}, house_colour(i)});
      panel.layers.back().opacity = 0.12;
      lines.push_back({Layer::Kind::line, outline, house_colour(i), label});
    }
    panel.layers.insert(panel.layers.end(), lines.begin(), lines.end());
    panel.layers.push_back({Layer::Kind::guides, {{0}}, "#909090", "", 1, Dash::dashed});
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure make_error_against_gradient(std::string const& title, DisplacementField const& truth,
                                   std::vector<ErrorSeries> const& series) {
  GLADSTONE_EXPECTS(!series.empty());
  std::vector<double> const gradient = local_gradient(truth);
  int const legend = 22 * static_cast<int>(series.size()) + 6;
  Figure figure{820, 520 + legend};
  figure.add_title(title);
  Panel panel{.box = {96, 790, 50.0 + legend, figure.height_px - 60.0}, .grid = Grid::both};
  panel.x.label = "local gradient of the true displacement, from vector to vector [px/px]";
  panel.y = {.label = "magnitude of the error [px]", .logarithmic = true};
  panel.legend.place = LegendPlace::above;
  std::vector<Layer> medians;
  for (std::size_t s = 0; s < series.size(); ++s) {
    BinnedErrors const binned = bin_errors(gradient, series[s].error_px);
    panel.layers.push_back({Layer::Kind::band, {binned.gradient, binned.low, binned.high}, house_colour(s)});
    panel.layers.back().opacity = 0.15;
    medians.push_back({.columns = {binned.gradient, binned.median},
                       .colour = house_colour(s),
                       .name = series[s].name + ": median, band 10–90 %",
                       .marker = 1,
                       .size = 0.7});
  }
  panel.layers.insert(panel.layers.end(), medians.begin(), medians.end());
  figure.panels.push_back(std::move(panel));
  return figure;
}

std::vector<double> local_gradient(DisplacementField const& field) {
  GLADSTONE_EXPECTS(field.columns > 0 && field.rows > 0);
  GLADSTONE_EXPECTS(static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows) == field.size());
  auto const index = [&](int column, int row) { return static_cast<std::size_t>(row) * field.columns + column; };
  std::vector<double> gradient(field.size(), not_a_number);
  for (int row = 0; row < field.rows; ++row) {
    for (int column = 0; column < field.columns; ++column) {
      std::size_t const left = index(std::max(column - 1, 0), row);
      std::size_t const right = index(std::min(column + 1, field.columns - 1), row);
      std::size_t const above = index(column, std::max(row - 1, 0));
      std::size_t const below = index(column, std::min(row + 1, field.rows - 1));
      auto const slope = [&](std::size_t from, std::size_t to, double Vec2d::*axis) {
        double const distance = field.position_px[to].*axis - field.position_px[from].*axis;
        return (field.displacement_px[to] - field.displacement_px[from]) / distance;  // NaN for a single row
      };
      Vec2d const dx = slope(left, right, &Vec2d::x);
      Vec2d const dy = slope(above, below, &Vec2d::y);
      // Largest singular value of [dx dy]: square root of the larger eigenvalue of its normal matrix.
      double const a = dot(dx, dx), b = dot(dx, dy), c = dot(dy, dy);
      gradient[index(column, row)] = std::sqrt(0.5 * (a + c) + std::hypot(0.5 * (a - c), b));
    }
  }
  return gradient;
}

Figure make_budget_bars(std::string const& title, ErrorBudget const& budget) {
  std::vector<BudgetTerm> terms = budget.terms;
  terms.push_back(budget.total);
  std::size_t const count = terms.size();
  Figure figure{160 + 108 * static_cast<int>(count), 520};
  figure.add_title(title);
  Panel panel{.box = {100, figure.width_px - 24.0, 84, 458}, .grid = Grid::horizontal};
  panel.x = {.low = -0.6, .high = static_cast<double>(count) - 0.4, .marks = Axis::Marks::bare};
  panel.y.label = "contribution [px]";
  panel.legend = {LegendPlace::above, 46, true};
  struct Part {
    char const *name, *colour;
    double BudgetTerm::*value;
  };
  double shift = -0.3;
  for (Part const& part : {Part{"bias u", "#56b4e9", &BudgetTerm::bias_u_px},
                           {"bias v", "#0072b2", &BudgetTerm::bias_v_px},
                           {"scatter u", "#e69f00", &BudgetTerm::random_u_px},
                           {"scatter v", "#d55e00", &BudgetTerm::random_v_px}}) {
    Layer layer{Layer::Kind::bars, {{}, {}, std::vector<double>(count, 0.18)}, part.colour, part.name};
    for (std::size_t i = 0; i < count; ++i) {
      layer.columns[0].push_back(static_cast<double>(i) + shift);
      layer.columns[1].push_back(terms[i].*part.value);
    }
    panel.layers.push_back(std::move(layer));
    shift += 0.2;
  }
  Layer rms{Layer::Kind::levels, {{}, {}, std::vector<double>(count, 0.42)}, "#202020", "rms"};
  for (std::size_t i = 0; i < count; ++i) {
    std::string name = terms[i].name;
    std::replace(name.begin(), name.end(), '_', ' ');
    std::string note = terms[i].known() ? "" : "n/a";
    if (!terms[i].includes.empty()) note = fmt::format("+ {}", fmt::join(terms[i].includes, ", "));
    panel.x.ticks.push_back({static_cast<double>(i), name.append("\n").append(note)});
    rms.columns[0].push_back(static_cast<double>(i));
    rms.columns[1].push_back(terms[i].rms_px);
  }
  panel.layers.push_back(std::move(rms));
  panel.layers.push_back({Layer::Kind::line, {{panel.x.low, panel.x.high}, {0, 0}}, "#404040", "", 1});
  panel.layers.push_back({Layer::Kind::guides, {{static_cast<double>(count) - 1.5}}, "#909090", "", 1, Dash::dashed});
  figure.panels.push_back(std::move(panel));
  return figure;
}

Figure make_reliability_figure(std::vector<UncertaintyBin> const& bins) {
  Layer points{Layer::Kind::points, {{}, {}}, house_colour(0), "bins of equal count"};
  points.marker = 1;
  double largest = 0;
  for (UncertaintyBin const& bin : bins) {
    points.columns[0].push_back(bin.rms_sigma_px);
    points.columns[1].push_back(bin.rms_error_px);
    points.notes.push_back(fmt::format("uncertainty {:.4g} px, error {:.4g} px\n{} components", bin.rms_sigma_px,
                                       bin.rms_error_px, bin.count));
    largest = std::max({largest, bin.rms_sigma_px, bin.rms_error_px});
  }
  double const end = largest > 0 ? 1.05 * largest : 1;
  Layer equal{.columns = {{0, end}, {0, end}}, .colour = "#808080", .name = "error equal to the uncertainty"};
  equal.width = 1.5;
  equal.dash = Dash::dashed;
  Panel panel{.box = {92, 790, 30, 420}, .layers = {std::move(equal), std::move(points)}, .grid = Grid::both};
  panel.x = {"estimated uncertainty, rms of the bin [px]", 0, end};
  panel.y = {"error, rms of the bin [px]", 0, end};
  panel.legend.place = LegendPlace::top_left;
  return {820, 480, Figure::Kind::chart, {}, {std::move(panel)}};
}

}  // namespace gladstone::inline figures
