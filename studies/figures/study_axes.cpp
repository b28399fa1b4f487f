#include "studies/figures/study_axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "analysis/errors/error_summary.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "studies/sweep/unit_ending.h"

namespace gladstone::inline figures {
namespace {

/// Returns the standard deviation of the steps between ascending numbers, relative to their mean.
double unevenness(std::vector<double> const& numbers) {
  double sum = 0, squares = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    double const step = numbers[i] - numbers[i - 1];
    sum += step;
    squares += step * step;
  }
  auto const n = static_cast<double>(numbers.size() - 1);
  return std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n))) / (sum / n);
}

bool is_logarithmic(std::vector<double> const& growing) {
  if (growing.size() < 3 || !(growing.front() > 0)) return false;
  if (growing.back() > 10 * growing.front()) return true;
  std::vector<double> logarithms;
  for (double const number : growing) logarithms.push_back(std::log(number));
  return unevenness(logarithms) < unevenness(growing);
}

std::string with_powers(std::string_view unit) {
  std::string text(unit);
  for (auto const& [plain, pretty] : {std::pair{"^2", "²"}, std::pair{"^3", "³"}, std::pair{"^4", "⁴"},
                                      std::pair{"um", "µm"}, std::pair{"deg", "°"}}) {
    auto const at = text.find(plain);
    if (at != std::string::npos) text.replace(at, std::string_view(plain).size(), pretty);
  }
  return text == "e" ? "e⁻" : text;
}

}  // namespace

std::string axis_title(std::string const& key) {
  static std::map<std::string, std::string> const known{{"lens.f_number", "f-number"},
                                                        {"geometry.z_a_mm", "Z_A"},
                                                        {"geometry.z_d_mm", "Z_D"},
                                                        {"medium.field", "density field"},
                                                        {"medium.field.file", "density field"},
                                                        {"correlate.window_px", "windows of the passes"},
                                                        {"target.dots_per_32px_window", "dots in 32 × 32 px"}};
  auto const unit = unit_ending(key);
  std::string const unit_text = unit ? fmt::format(" [{}]", with_powers(unit->unit)) : "";
  if (auto const found = known.find(key); found != known.end()) return found->second + unit_text;
  std::string name = key.substr(key.rfind('.') + 1);
  if (unit) name.resize(name.size() - unit->ending.size());
  std::replace(name.begin(), name.end(), '_', ' ');
  return name + unit_text;
}

std::string axis_value_text(std::string const& title, std::string const& label) {
  auto const bracket = title.find(" [");
  if (bracket == std::string::npos) return title + " = " + label;
  std::string const unit = title.substr(bracket + 2, title.size() - bracket - 3);
  return fmt::format("{} = {} {}", title.substr(0, bracket), label, unit);
}

FigureAxis figure_axis(StudyAxis const& axis, std::size_t most) {
  GLADSTONE_EXPECTS(most > 1);
  std::size_t const count = axis.labels.size();
  FigureAxis figure;
  figure.title = axis_title(axis.key);
  // infinity has no position on a scale
  figure.numeric = axis.numeric && std::all_of(axis.numbers.begin(), axis.numbers.end(),
                                               [](double number) { return std::isfinite(number); });
  figure.binned = figure.numeric && count > most;
  figure.labelled = figure.numeric && axis.labelled && !figure.binned;
  figure.place_of.resize(count);
  std::size_t const places = std::min(count, most);
  if (!figure.numeric) {
    for (std::size_t i = 0; i < count; ++i) figure.place_of[i] = std::min(i, places - 1);
    for (std::size_t i = 0; i < places; ++i) {
      figure.position.push_back(static_cast<double>(i));
      figure.label.push_back(i + 1 < places || count == places ? axis.labels[i] : "others");
    }
    return figure;
  }
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return axis.numbers[a] < axis.numbers[b]; });
  std::vector<double> growing;
  for (std::size_t const i : order) growing.push_back(axis.numbers[i]);
  figure.logarithmic = is_logarithmic(growing);
  for (std::size_t place = 0; place < places; ++place) {
    double sum = 0;
    std::size_t const first = place * count / places, end = (place + 1) * count / places;
    for (std::size_t k = first; k < end; ++k) {
      figure.place_of[order[k]] = place;
      sum += figure.logarithmic ? std::log(growing[k]) : growing[k];
    }
    double const mean = sum / static_cast<double>(end - first);
    figure.position.push_back(!figure.binned ? growing[first] : figure.logarithmic ? std::exp(mean) : mean);
    figure.label.push_back(figure.binned ? fmt::format("{:.3g}", figure.position.back()) : axis.labels[order[first]]);
  }
  return figure;
}

Scatter compute_scatter(std::vector<double> values, bool only_repeats_differ) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {not_a_number, not_a_number, not_a_number};
  if (!only_repeats_differ) return {quantile(values, 0.5), quantile(values, 0.1), quantile(values, 0.9)};
  double squares = 0;
  for (double const value : values) squares += value * value;
  auto const [low, high] = std::minmax_element(values.begin(), values.end());
  return {std::sqrt(squares / static_cast<double>(values.size())), *low, *high};
}

}  // namespace gladstone::inline figures
