#include "render/setup/setup_reading.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/nearest_name.h"
#include "render/setup/toml_text.h"

namespace gladstone::inline setup::setup_reading {
namespace {

using Kind = SetupNode::Kind;

std::string plain(double value) {
  std::string const text = toml_text(value);
  return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
}

}  // namespace

double in_unit(double si, double unit) {
  double const value = si / unit;
  if (value == 0 || !std::isfinite(value)) return value;
  int const places = std::clamp(11 - static_cast<int>(std::floor(std::log10(std::abs(value)))), 0, 22);
  double const scale = std::pow(10.0, places);
  return std::round(value * scale) / scale;
}

std::string broken_rule(double value, Range const& range) {
  if (std::isnan(value)) return "must be a number (nan is not allowed)";
  if (std::isinf(value) && !range.allow_inf) return "must be finite";
  bool const too_low = range.low_open ? value <= range.low : value < range.low;
  if (!too_low && value <= range.high) return {};
  bool const has_low = std::isfinite(range.low), has_high = std::isfinite(range.high);
  std::string rule = "must be ";
  if (has_low) rule += (range.low_open ? "greater than " : "at least ") + plain(range.low);
  if (has_low && has_high) rule += " and ";
  if (has_high) rule += "at most " + plain(range.high);
  return rule;
}

double harmless(Range const& range) {
  if (broken_rule(1.0, range).empty()) return 1.0;
  if (broken_rule(range.low, range).empty()) return range.low;
  if (!std::isfinite(range.high)) return range.low + 1.0;
  return std::isfinite(range.low) ? 0.5 * (range.low + range.high) : range.high;
}

std::string wrong_kind(std::string const& wanted, SetupNode const& node) {
  std::string message = "must be " + wanted + " (it is " + kind_name(node) + ')';
  if (node.kind != Kind::text) return message;
  auto const bare = parse_toml_value(node.text);
  if (bare && (bare->is_number() || bare->kind == Kind::boolean)) message += "; write it without quotes";
  return message;
}

std::string wrong_integer(SetupNode const& node) {
  if (node.kind != Kind::number) return wrong_kind("a whole number", node);
  std::string message = "must be a whole number";
  bool const whole = std::isfinite(node.number) && node.number == std::trunc(node.number);
  if (whole && std::abs(node.number) < 1e15) {
    message += "; write " + std::to_string(static_cast<long long>(node.number));
  }
  return message;
}

std::string between(long long low, long long high) {
  if (high == std::numeric_limits<long long>::max()) return "must be at least " + std::to_string(low);
  if (low == std::numeric_limits<long long>::min()) return "must be at most " + std::to_string(high);
  return "must be at least " + std::to_string(low) + " and at most " + std::to_string(high);
}

std::string wrong_word(std::string const& text, std::vector<std::string> const& words) {
  std::string message = "must be " + quoted_list(words);
  if (auto const nearest = nearest_name(text, words)) message += "; did you mean \"" + *nearest + "\"?";
  return message;
}

}  // namespace gladstone::inline setup::setup_reading
