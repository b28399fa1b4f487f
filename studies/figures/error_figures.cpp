#include "studies/figures/error_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {
namespace {

std::vector<double> component(std::vector<Vec2d> const& values, double Vec2d::*part) {
  std::vector<double> result;
  for (Vec2d const& value : values) {
    if (is_finite(value)) result.push_back(value.*part);
  }
  return result;
}

void set_title(GnuplotFigure& plot, std::string const& title) {
  plot.command(
      fmt::format("set label 1 {} at screen 0.5, screen {:.6f} center font 'DejaVu Sans,14' textcolor '#101010'",
                  GnuplotFigure::quoted(title), 1.0 - 26.0 / plot.height_px()));
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

constexpr char const* light_grid = "set grid linecolor '#e4e4e4' linewidth 1 linetype 1";

}  // namespace

void write_error_histograms(std::string const& path, std::string const& title, std::vector<ErrorSeries> const& series) {
  GLADSTONE_EXPECTS(!series.empty());
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
  double const reach = widest > 0.0 ? std::min(widest, 8.0 * narrowest) : 1e-3;

  int const legend = 22 * static_cast<int>(series.size()) + 10;
  GnuplotFigure plot(1200, 430 + legend);
  plot.command("set multiplot");
  set_title(plot, title);
  plot.command(light_grid);
  plot.command("set ylabel 'probability density [1/px]' offset 0.5,0");
  plot.command("set style fill transparent solid 0.12 noborder");
  int column = 0;
  for (double Vec2d::*part : {&Vec2d::x, &Vec2d::y}) {
    plot.set_margins(column == 0 ? 80 : 680, column == 0 ? 570 : 1170, 50 + legend, plot.height_px() - 58);
    plot.command(fmt::format("set key at graph 0, screen {:.6f} left top Left reverse samplen 2 font 'DejaVu Sans,10'",
                             1.0 - 46.0 / plot.height_px()));
    plot.command(
        fmt::format("set xlabel {}", GnuplotFigure::quoted(column == 0 ? "error of u [px]" : "error of v [px]")));
    plot.command(fmt::format("set xrange [{:.10g}:{:.10g}]; set yrange [0:*]", -reach, reach));
    plot.command("set arrow 1 from 0, graph 0 to 0, graph 1 nohead linecolor '#909090' linewidth 1 dashtype 2");
    std::string fills = "plot ";
    std::string lines;
    for (std::size_t i = 0; i < series.size(); ++i) {
      std::vector<double> const errors = component(series[i].error_px, part);
      std::vector<Vec2d> const zero(series[i].error_px.size());
      ErrorSummary const summary = summarize_errors(series[i].error_px, zero, {});
      double const bias = column == 0 ? summary.bias_u_px : summary.bias_v_px;
      double const random = column == 0 ? summary.random_u_px : summary.random_v_px;
      std::string const source = plot.add_table(density_of(errors, reach, 81));
      std::string const label = errors.empty()
                                    ? fmt::format("{}: no vectors", series[i].name)
                                    : fmt::format("{}: bias {:+.4f}, random {:.4f} px", series[i].name, bias, random);
      if (i > 0) fills += ", ";
      fills += fmt::format("{} using 1:2 with filledcurves y=0 linecolor '{}'", source, house_colour(i));
      lines += fmt::format(", {} using 1:2 with lines linewidth 2 linecolor '{}' title {}", source, house_colour(i),
                           GnuplotFigure::quoted(label));
    }
    plot.command(fills + lines);
    plot.command("unset label 1");
    ++column;
  }
  plot.command("unset multiplot");
  plot.write(path);
}

void write_error_against_gradient(std::string const& path, std::string const& title, DisplacementField const& truth,
                                  std::vector<ErrorSeries> const& series) {
  GLADSTONE_EXPECTS(!series.empty());
  std::vector<double> const gradient = local_gradient(truth);
  int const legend = 22 * static_cast<int>(series.size()) + 6;
  GnuplotFigure plot(820, 520 + legend);
  set_title(plot, title);
  plot.command(light_grid);
  plot.set_margins(96, 790, 50 + legend, plot.height_px() - 60);
  plot.command(
      fmt::format("set key at graph 0, screen {:.6f} left top Left reverse samplen 2", 1.0 - 46.0 / plot.height_px()));
  plot.command("set xlabel 'local gradient of the true displacement, from vector to vector [px/px]'");
  plot.command("set ylabel 'magnitude of the error [px]' offset -0.5,0");
  plot.command("set logscale y; set format y '%g'");
  plot.command("set style fill transparent solid 0.15 noborder");
  std::string bands = "plot ";
  std::string medians;
  for (std::size_t s = 0; s < series.size(); ++s) {
    GLADSTONE_EXPECTS(series[s].error_px.size() == gradient.size());
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < gradient.size(); ++i) {
      if (std::isfinite(gradient[i]) && is_finite(series[s].error_px[i])) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return gradient[a] < gradient[b]; });

    // Bins of equal count, with at least 20 vectors each if there are enough.
    std::size_t const bins = std::clamp<std::size_t>(order.size() / 20, 1, 15);
    std::vector<std::vector<double>> curve(4);
    for (std::size_t bin = 0; bin < bins && !order.empty(); ++bin) {
      std::vector<double> place_of, magnitude;
      for (std::size_t k = bin * order.size() / bins; k < (bin + 1) * order.size() / bins; ++k) {
        place_of.push_back(gradient[order[k]]);
        // positive for the logarithmic axis
        magnitude.push_back(std::max(length(series[s].error_px[order[k]]), 1e-15));
      }
      if (magnitude.empty()) continue;
      curve[0].push_back(quantile(place_of, 0.5));
      curve[1].push_back(quantile(magnitude, 0.5));
      curve[2].push_back(quantile(magnitude, 0.1));
      curve[3].push_back(quantile(magnitude, 0.9));
    }
    if (curve[0].empty()) {
      for (auto& values : curve) values.push_back(not_a_number);
    }
    std::string const source = plot.add_table(curve);
    if (s > 0) bands += ", ";
    bands += fmt::format("{} using 1:3:4 with filledcurves linecolor '{}'", source, house_colour(s));
    medians +=
        fmt::format(", {} using 1:2 with linespoints linewidth 2 pointtype 7 pointsize 0.7 linecolor '{}' title {}",
                    source, house_colour(s), GnuplotFigure::quoted(series[s].name + ": median, band 10–90 %"));
  }
  plot.command(bands + medians);
  plot.write(path);
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

void write_budget_bars(std::string const& path, std::string const& title, ErrorBudget const& budget) {
  std::vector<BudgetTerm> terms = budget.terms;
  terms.push_back(budget.total);
  auto const count = static_cast<int>(terms.size());
  GnuplotFigure plot(160 + 108 * count, 520);
  set_title(plot, title);
  plot.set_margins(100, plot.width_px() - 24, 84, plot.height_px() - 62);
  plot.command("set grid ytics linecolor '#e4e4e4' linewidth 1 linetype 1");
  plot.command(fmt::format("set key at graph 0, screen {:.6f} left top Left reverse horizontal samplen 1.5",
                           1.0 - 46.0 / plot.height_px()));
  plot.command("set ylabel 'contribution [px]' offset 0.5,0");
  plot.command(fmt::format("set xrange [-0.6:{:.1f}]; set xtics scale 0 font 'DejaVu Sans,10'", count - 0.4));
  plot.command("set xzeroaxis linetype 1 linecolor '#404040' linewidth 1");
  plot.command("set boxwidth 0.18 absolute; set style fill solid 1.0 noborder");
  plot.command(
      fmt::format("set arrow 1 from {0}, graph 0 to {0}, graph 1 nohead linecolor '#909090' dashtype 2", count - 1.5));
  std::string tics = "set xtics (";
  std::vector<std::vector<double>> columns(6);
  for (int i = 0; i < count; ++i) {
    BudgetTerm const& term = terms[static_cast<std::size_t>(i)];
    std::string name = term.name;
    std::replace(name.begin(), name.end(), '_', ' ');
    std::string note = term.known() ? "" : "n/a";
    if (!term.includes.empty()) note = fmt::format("+ {}", fmt::join(term.includes, ", "));
    tics += fmt::format("{}\"{}\\n{}\" {}", i == 0 ? "" : ", ", name, note, i);
    columns[0].push_back(i);
    columns[1].push_back(term.bias_u_px);
    columns[2].push_back(term.bias_v_px);
    columns[3].push_back(term.random_u_px);
    columns[4].push_back(term.random_v_px);
    columns[5].push_back(term.rms_px);
  }
  plot.command(tics + ")");
  std::string const source = plot.add_table(columns);
  constexpr std::string_view names[] = {"bias u", "bias v", "scatter u", "scatter v"};
  constexpr std::string_view colours[] = {"#56b4e9", "#0072b2", "#e69f00", "#d55e00"};
  std::string bars = "plot ";
  for (int k = 0; k < 4; ++k) {
    bars += fmt::format("{} using ($1{:+.2f}):{} with boxes linecolor '{}' title '{}', ", source, -0.3 + 0.2 * k, k + 2,
                        colours[k], names[k]);
  }
  bars += fmt::format("{} using 1:6:(0.42) with xerrorbars pointtype 0 linewidth 2 linecolor '#202020' title 'rms'",
                      source);
  plot.command(bars);
  plot.write(path);
}

}  // namespace gladstone
