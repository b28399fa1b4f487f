#include "studies/figures/study_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/parallel.h"
#include "studies/figures/study_drawings.h"
#include "studies/sweep/study_points.h"

namespace gladstone {
namespace study_drawing {
namespace {

constexpr double letter_px = 7.6;

/// Returns true if the tic labels do not fit side by side.
bool crowded(FigureAxis const& axis, double width_px) {
  std::size_t longest = 0;
  for (std::string const& label : axis.label) longest = std::max(longest, label.size());
  return letter_px * static_cast<double>(longest + 2) > width_px / static_cast<double>(axis.size());
}

/// Returns true if tics at every position would overlap.
bool dense(FigureAxis const& axis, double width_px) {
  auto const at = [&](std::size_t i) { return axis.logarithmic ? std::log(axis.position[i]) : axis.position[i]; };
  double const span = at(axis.size() - 1) - at(0);
  for (std::size_t i = 1; i < axis.size(); ++i) {
    double const gap = 0.9 * width_px * (at(i) - at(i - 1)) / span;
    if (gap < 0.5 * letter_px * static_cast<double>(axis.label[i].size() + axis.label[i - 1].size() + 1)) return true;
  }
  return axis.binned;
}

}  // namespace

void set_texts(GnuplotFigure& plot, std::string const& title, std::string const& caption) {
  plot.command(
      fmt::format("set label 1 {} at screen 0.5, screen {:.6f} center font 'DejaVu Sans,14' textcolor '#101010'",
                  GnuplotFigure::quoted(title), 1.0 - 26.0 / plot.height_px()));
  auto const line = caption.find('\n');
  for (int i = 0; i < 2; ++i) {
    if (i == 1 && line == std::string::npos) break;
    std::string const text = i == 0 ? caption.substr(0, line) : caption.substr(line + 1);
    plot.command(fmt::format(
        "set label {} {} at screen 0.5, screen {:.6f} center font 'DejaVu Sans,9' textcolor '#505050'", i + 2,
        GnuplotFigure::quoted(text), (line == std::string::npos ? 14.0 : 28.0 - 16.0 * i) / plot.height_px()));
  }
}

int room_below(FigureAxis const& axis, double width_px) {
  if (axis.numeric ? !axis.labelled || !dense(axis, width_px) : !crowded(axis, width_px)) return 56;
  std::size_t longest = 0;
  for (std::string const& label : axis.label) longest = std::max(longest, label.size());
  return 60 + static_cast<int>(0.5 * letter_px * static_cast<double>(longest));
}

void set_x_axis(GnuplotFigure& plot, FigureAxis const& axis, double width_px) {
  plot.command("unset logscale x; set xtics nomirror out scale 0.5 norotate autofreq font 'DejaVu Sans,10' offset 0,0");
  plot.command(fmt::format("set xlabel {}", GnuplotFigure::quoted(axis.title)));
  double const first = axis.position.front(), last = axis.position.back();
  if (axis.numeric && axis.logarithmic) {
    double const margin = std::pow(last / first, 0.06);
    plot.command(fmt::format("set logscale x; set xrange [{:.10g}:{:.10g}]", first / margin, last * margin));
    if (dense(axis, width_px) && !axis.labelled) {
      plot.command("set xtics " + logarithmic_tics(first / margin, last * margin));
      return;
    }
  } else if (axis.numeric) {
    double const margin = 0.06 * (last - first);
    plot.command(fmt::format("set xrange [{:.10g}:{:.10g}]", first - margin, last + margin));
    if (dense(axis, width_px) && !axis.labelled) return;
  } else {
    plot.command(fmt::format("set xrange [-0.5:{:.1f}]", last + 0.5));
  }
  if (axis.numeric ? dense(axis, width_px) : crowded(axis, width_px)) plot.command("set xtics rotate by 28 right");
  std::string tics;
  for (std::size_t i = 0; i < axis.size(); ++i) {
    tics += fmt::format("{}{} {:.10g}", i > 0 ? ", " : "", GnuplotFigure::quoted_tic(axis.label[i]), axis.position[i]);
  }
  plot.command("set xtics (" + tics + ')');
}

void set_y_axis(GnuplotFigure& plot, std::string const& title, double low, double high) {
  plot.command("unset logscale y; set ytics autofreq font 'DejaVu Sans,10'");
  plot.command(fmt::format("set ylabel {}", GnuplotFigure::quoted(title)));
  if (low > 0 && high > 4 * low) {
    double const margin = std::pow(high / low, 0.06);
    plot.command(fmt::format("set logscale y; set yrange [{:.10g}:{:.10g}]", low / margin, high * margin));
    plot.command("set ytics " + logarithmic_tics(low / margin, high * margin));
  } else {
    plot.command(fmt::format("set yrange [0:{:.10g}]", high > 0 ? 1.12 * high : 1.0));
  }
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

std::vector<std::string> draw_study(std::string const& folder, StudyTable const& table,
                                    std::vector<std::string> const& formats) {
  StudyCells const cells(table), map_cells(table, sampled_places_in_maps(table.points.size()));
  bool const repeated = table.repeats() > 1;
  StudyTable const point_table = repeated ? study_points(table) : StudyTable{};
  StudyCells const points(point_table);
  std::vector<std::unique_ptr<GnuplotFigure>> figures;
  std::vector<std::string> paths;  // one per figure and format
  auto const add = [&](std::unique_ptr<GnuplotFigure> figure, std::string const& name) {
    if (!figure) return;
    figures.push_back(std::move(figure));
    for (std::string const& format : formats) paths.push_back(fmt::format("{}/{}.{}", folder, name, format));
  };
  std::vector<std::size_t> const& varied = cells.varied();
  for (std::size_t i = 0; i < varied.size(); ++i) {
    std::string const name = file_part(cells.key(varied[i]));
    add(draw_error_curves(cells, varied[i]), "error_against_" + name);
    add(draw_budget(cells, varied[i], repeated ? &points : nullptr), "budget_" + name);
    if (repeated) add(draw_repeats(points, varied[i]), "repeats_" + name);
    for (std::size_t j = i + 1; j < varied.size(); ++j) {
      add(draw_error_map(map_cells, varied[j], varied[i]),
          fmt::format("error_map_{}_{}", name, file_part(cells.key(varied[j]))));
    }
  }
  // gnuplot dominates the run time: run one process per figure, in parallel
  parallel_for(figures.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < formats.size(); ++k) figures[i]->write(paths[i * formats.size() + k]);
  });
  return paths;
}

}  // namespace gladstone
