#include "studies/sweep/study_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gladstone::inline sweep {
namespace {

/// Rounds to twelve digits, so that values of a range are short decimals: 0.1 instead of 0.30000000000000004 - 0.2.
double rounded_setting(double value) {
  std::string const text = fmt::format("{:.12g}", value);
  double result = value;
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

AxisValue number_value(double number, bool whole, SetupPlace const& place) {
  AxisValue value;
  value.node.place = place;
  bool const integer = whole && number == std::floor(number) && std::abs(number) < 0x1p53;
  value.node.kind = integer ? SetupNode::Kind::integer : SetupNode::Kind::number;
  value.node.integer = integer ? static_cast<long long>(number) : 0;
  value.node.number = number;
  value.parameter = {number_label(number), number};
  return value;
}

double along(AxisPlan::Range const& range, double t) {
  if (!range.logarithmic) return rounded_setting(range.first + t * (range.last - range.first));
  return rounded_setting(range.first * std::pow(range.last / range.first, t));
}

}  // namespace

AxisValue AxisPlan::value(std::size_t i) const {
  if (!range) return list[i];
  double number = range->first;
  if (i > 0) number = i + 1 == range->count ? range->last : along(*range, static_cast<double>(i) / (range->count - 1));
  return number_value(number, range->whole, place);
}

AxisValue AxisPlan::value_at(double u) const {
  if (range) return number_value(along(*range, u), false, place);
  return list[std::min(list.size() - 1, static_cast<std::size_t>(u * static_cast<double>(list.size())))];
}

bool surely_tells_values_apart(AxisPlan::Range const& range) {
  double const steps = static_cast<double>(range.count - 1);
  if (range.logarithmic) return std::abs(std::log(range.last / range.first)) > 2e-11 * steps;
  return std::abs(range.last - range.first) > 2e-11 * steps * std::max(std::abs(range.first), std::abs(range.last));
}

}  // namespace gladstone::inline sweep
