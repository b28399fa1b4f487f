#include "studies/figures/study_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/base/parallel.h"
#include "studies/drawing/draw_figure.h"
#include "studies/drawing/figure_texts.h"
#include "studies/figures/study_drawings.h"
#include "studies/sweep/study_points.h"

namespace gladstone::inline figures {
namespace study_drawing {
namespace {

using namespace plot;

constexpr double between = 12;  ///< least distance of tick texts [px]
constexpr double slant = 0.47;  ///< sine of the angle of slanted texts

double tick_width(std::string const& text) { return text_width(text, font_of(Figure::Kind::chart, "tick")); }

double longest_tick(FigureAxis const& axis) {
  double longest = 0;
  for (std::string const& label : axis.label) longest = std::max(longest, tick_width(label));
  return longest;
}

/// Returns true if the texts of categories do not fit side by side.
bool crowded(FigureAxis const& axis, double width_px) {
  return longest_tick(axis) + between > width_px / static_cast<double>(axis.size());
}

/// Returns true if ticks at every number would overlap.
bool dense(FigureAxis const& axis, double width_px) {
  auto const at = [&](std::size_t i) { return axis.logarithmic ? std::log(axis.position[i]) : axis.position[i]; };
  double const span = at(axis.size() - 1) - at(0);
  for (std::size_t i = 1; i < axis.size(); ++i) {
    double const gap = 0.9 * width_px * (at(i) - at(i - 1)) / span;
    if (gap < 0.5 * (tick_width(axis.label[i]) + tick_width(axis.label[i - 1])) + between) return true;
  }
  return axis.binned;
}

/// Returns true if the texts of the ticks are slanted; numbers without names have automatic ticks instead.
bool slanted(FigureAxis const& axis, double width_px) {
  return axis.numeric ? axis.labelled && dense(axis, width_px) : crowded(axis, width_px);
}

}  // namespace

void add_texts(Figure& figure, std::string const& title, std::string const& caption) {
  figure.add_title(title);
  auto const line = caption.find('\n');
  double const middle = figure.width_px / 2.0, bottom = figure.height_px;
  if (line != std::string::npos) {
    figure.labels.push_back({caption.substr(0, line), middle, bottom - 28, TextRole::caption});
    figure.labels.push_back({caption.substr(line + 1), middle, bottom - 12, TextRole::caption});
  } else {
    figure.labels.push_back({caption, middle, bottom - 14, TextRole::caption});
  }
}

int room_below(FigureAxis const& axis, double width_px) {
  return slanted(axis, width_px) ? 60 + static_cast<int>(slant * longest_tick(axis)) : 56;
}

std::vector<Tick> label_ticks(FigureAxis const& axis, std::vector<double> const& position) {
  std::vector<Tick> ticks;
  for (std::size_t i = 0; i < axis.size(); ++i) ticks.push_back({position[i], axis.label[i]});
  return ticks;
}

Axis make_x_axis(FigureAxis const& axis, double width_px) {
  Axis made{.label = axis.title, .ticks = label_ticks(axis, axis.position), .slanted = slanted(axis, width_px)};
  double const first = axis.position.front(), last = axis.position.back();
  if (!axis.numeric) {
    made.low = -0.5;
    made.high = last + 0.5;
    return made;
  }
  made.logarithmic = axis.logarithmic;
  double const margin = axis.logarithmic ? std::pow(last / first, 0.06) : 0.06 * (last - first);
  made.low = axis.logarithmic ? first / margin : first - margin;
  made.high = axis.logarithmic ? last * margin : last + margin;
  if (!axis.labelled && dense(axis, width_px)) {
    made.ticks = axis.logarithmic ? logarithmic_ticks(made.low, made.high) : std::vector<Tick>{};
  }
  return made;
}

Axis make_y_axis(std::string const& title, double low, double high) {
  if (low > 0 && high > 4 * low) {
    double const margin = std::pow(high / low, 0.06);
    return {title, low / margin, high * margin, true, logarithmic_ticks(low / margin, high * margin)};
  }
  return {title, 0, high > 0 ? 1.12 * high : 1.0};
}

std::vector<ErrorMeasure> known_errors(StudyCells const& cells) {
  std::vector<ErrorMeasure> errors{{"ray_truth.rms_px", "measured − ray truth"},
                                   {"eq9.rms_px", "measured − Eq. 9"},
                                   {"flow.rms_px", "measured − flow"},
                                   {"eq9_cone.rms_px", "measured − aperture-averaged Eq. 9"},
                                   {"window_truth.rms_px", "measured − ray truth on the window"}};
  std::erase_if(errors, [&](ErrorMeasure const& error) {
    std::vector<double> const values = cells.values(error.measure, cells.rows_at({}));
    return std::none_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
  });
  return errors;
}

std::string study_name(StudyCells const& cells) {
  return fmt::format("study {}, {} cases", cells.table().name, cells.finished());
}

std::string meaning(bool only_repeats_differ, std::size_t repeats) {
  if (!only_repeats_differ) return "points: medians of the cases, bars: 10 to 90 % of them";
  if (repeats < 2) return "points: single cases";
  return fmt::format("points: root mean square over {} repeats, bars: smallest to largest", repeats);
}

}  // namespace study_drawing

namespace {

/// Converts a key path to a part of a file name.
std::string file_part(std::string key) {
  std::replace_if(
      key.begin(), key.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return key;
}

}  // namespace

StudyFigureMaker::StudyFigureMaker(StudyTable const& table)
    : cells_(table),
      map_cells_(table, sampled_places_in_maps(table.points.size())),
      point_table_(table.repeats() > 1 ? std::optional(study_points(table)) : std::nullopt),
      points_(point_table_ ? std::optional<StudyCells>(*point_table_) : std::nullopt) {}

std::optional<Figure> StudyFigureMaker::make_errors(std::size_t axis) const { return make_error_curves(cells_, axis); }

std::optional<Figure> StudyFigureMaker::make_budget(std::size_t axis) const {
  return figures::make_budget(cells_, axis, points_ ? &*points_ : nullptr);
}

std::optional<Figure> StudyFigureMaker::make_repeats(std::size_t axis) const {
  return points_ ? figures::make_repeats(*points_, axis) : std::nullopt;
}

std::optional<Figure> StudyFigureMaker::make_coverage(std::size_t axis) const {
  return figures::make_coverage(cells_, axis);
}

std::optional<Figure> StudyFigureMaker::make_map(std::size_t x_axis, std::size_t y_axis) const {
  return make_error_map(map_cells_, x_axis, y_axis);
}

std::optional<Figure> StudyFigureMaker::make_case_points() const { return figures::make_case_points(cells_); }

std::vector<std::string> draw_study(std::string const& folder, StudyTable const& table,
                                    std::vector<std::string> const& formats) {
  StudyFigureMaker const study(table);
  std::vector<Figure> figures;
  std::vector<std::string> paths;  // one per figure and format
  auto const add = [&](std::optional<Figure> figure, std::string const& name) {
    if (!figure) return;
    figures.push_back(*std::move(figure));
    for (std::string const& format : formats) paths.push_back(fmt::format("{}/{}.{}", folder, name, format));
  };
  std::vector<std::size_t> const& varied = study.varied();
  for (std::size_t i = 0; i < varied.size(); ++i) {
    std::string const name = file_part(table.axes[varied[i]].key);
    add(study.make_errors(varied[i]), "error_against_" + name);
    add(study.make_budget(varied[i]), "budget_" + name);
    add(study.make_repeats(varied[i]), "repeats_" + name);
    for (std::size_t j = i + 1; j < varied.size(); ++j) {
      add(study.make_map(varied[j], varied[i]),
          fmt::format("error_map_{}_{}", name, file_part(table.axes[varied[j]].key)));
    }
  }
  // gnuplot dominates the run time: run one process per file, in parallel
  parallel_for(paths.size(), [&](std::size_t i) { draw_figure(figures[i / formats.size()], paths[i]); });
  return paths;
}

}  // namespace gladstone::inline figures
