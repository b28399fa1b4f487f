#include "render/base/setup_table.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "render/base/nearest_name.h"
#include "render/base/setup_state.h"

namespace gladstone {
namespace {

/// A default in SI as a setup writes it: to 12 digits, without what products with a unit leave of rounding.
double in_unit(double si, double unit) {
  double const value = si / unit;
  if (value == 0 || !std::isfinite(value)) return value;
  int const places = std::clamp(11 - static_cast<int>(std::floor(std::log10(std::abs(value)))), 0, 22);
  double const scale = std::pow(10.0, places);
  return std::round(value * scale) / scale;
}

using Kind = SetupNode::Kind;

std::vector<std::string> below(std::vector<std::string> path, std::string const& key) {
  path.push_back(key);
  return path;
}

std::string plain(double value) {
  std::string const text = toml_text(value);
  return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
}

/// What a number breaks of its range, with the rule; empty where it keeps it.
std::string broken_rule(double value, Range const& range) {
  if (std::isnan(value)) return "must be a number (nan is none)";
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

/// Some number that the range allows.
double harmless(Range const& range) {
  if (broken_rule(1.0, range).empty()) return 1.0;
  if (broken_rule(range.low, range).empty()) return range.low;
  if (!std::isfinite(range.high)) return range.low + 1.0;
  return std::isfinite(range.low) ? 0.5 * (range.low + range.high) : range.high;
}

/// "must be a number (it is a text)", with a hint where quotes are the mistake.
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

std::string counted(std::size_t at_least, std::size_t at_most) {
  if (at_least == at_most) return std::to_string(at_least);
  if (at_most == std::numeric_limits<std::size_t>::max()) return std::to_string(at_least) + " or more";
  return std::to_string(at_least) + " to " + std::to_string(at_most);
}

template <class Value, class Text>
std::string array_text(std::vector<Value> const& values, Text const& text) {
  std::string list;
  for (auto const& value : values) list += (list.empty() ? "" : ", ") + text(value);
  return '[' + list + ']';
}

std::string boolean_text(bool value) { return value ? "true" : "false"; }

/// Marks a key as known to its table.
SetupRecord::Entry& known(SetupDocument::State& state, std::vector<std::string> const& table, std::string const& key) {
  return state.record_of(table).entry(key);
}

/// The value of a key being read; null where it is absent.
SetupNode const* read(SetupDocument::State& state, std::vector<std::string> const& table, std::string const& key) {
  known(state, table, key).read = true;
  return state.find(below(table, key));
}

/// Remembers what a key came to.
void use(SetupDocument::State& state, std::vector<std::string> const& table, std::string const& key,
         std::string const& value) {
  auto& entry = known(state, table, key);
  if (!entry.resolved) entry.value = value;
}

/// What a key came to in the end.
void settle(SetupDocument::State& state, std::vector<std::string> const& table, std::string const& key,
            std::string const& value) {
  auto& entry = known(state, table, key);
  entry.value = value;
  entry.resolved = true;
}

/// The elements of an array with an allowed count and, each, nothing to object to; null, with problems, otherwise.
template <class Objection>
SetupNode const* read_array(SetupTable& table, SetupNode const* node, std::string const& key, std::string const& wanted,
                            std::size_t at_least, std::size_t at_most, Objection const& objection) {
  if (!node) return nullptr;
  std::string const form = "an array of " + counted(at_least, at_most) + ' ' + wanted;
  if (node->kind != Kind::array) {
    std::string const bracketed = node->kind == Kind::text ? '[' + node->text + ']' : std::string();
    bool const brackets_are_missing = !bracketed.empty() && parse_toml_value(bracketed);
    table.problem(key, wrong_kind(form, *node) + (brackets_are_missing ? "; write " + bracketed : ""));
    return nullptr;
  }
  std::size_t const count = node->elements.size();
  if (count < at_least || count > at_most) {
    table.problem(key, "must be " + form + " (it has " + std::to_string(count) + ')');
    return nullptr;
  }
  for (std::size_t i = 0; i < count; ++i) {
    std::string const broken = objection(node->elements[i]);
    if (broken.empty()) continue;
    table.problem(key, "value " + std::to_string(i + 1) + ", " + toml_text(node->elements[i]) + ", " + broken);
    return nullptr;
  }
  return node;
}

}  // namespace

SetupTable::SetupTable(SetupDocument::State* state, std::vector<std::string> path)
    : state_(state), path_(std::move(path)) {
  state_->record_of(path_).present = present();
}

SetupTable SetupTable::table(std::string const& key) {
  auto const* const node = read(*state_, path_, key);
  if (node && node->kind == Kind::array) {
    problem(key, "must be one table; write [" + dotted_path(below(path_, key)) + "] once, in single brackets");
  } else if (node && node->kind != Kind::table) {
    problem(key, wrong_kind("a table", *node) + "; write [" + dotted_path(below(path_, key)) + "] and its keys below");
  }
  return SetupTable(state_, below(path_, key));
}

std::vector<SetupTable> SetupTable::tables(std::string const& key) {
  auto const* const node = read(*state_, path_, key);
  auto const path = below(path_, key);
  std::vector<SetupTable> found;
  if (!node) return found;
  if (node->kind == Kind::table) {
    found.emplace_back(state_, path);
    return found;
  }
  auto const is_table = [](SetupNode const& element) { return element.kind == Kind::table; };
  if (node->kind != Kind::array || !std::all_of(node->elements.begin(), node->elements.end(), is_table)) {
    problem(key, "must be a table or an array of tables; write [" + dotted_path(path) + "] or [[" + dotted_path(path) +
                     "]]");
    return found;
  }
  for (std::size_t i = 0; i < node->elements.size(); ++i) {
    found.emplace_back(state_, below(path, '[' + std::to_string(i) + ']'));
  }
  return found;
}

bool SetupTable::has(std::string const& key) const {
  known(*state_, path_, key);
  return state_->find(below(path_, key)) != nullptr;
}

bool SetupTable::is_string(std::string const& key) const {
  return has(key) && state_->find(below(path_, key))->kind == Kind::text;
}

bool SetupTable::is_array(std::string const& key) const {
  return has(key) && state_->find(below(path_, key))->kind == Kind::array;
}

bool SetupTable::is_table(std::string const& key) const {
  return has(key) && state_->find(below(path_, key))->kind == Kind::table;
}

bool SetupTable::present() const {
  auto const* const node = state_->find(path_);
  return node && node->kind == Kind::table;
}

std::optional<double> SetupTable::optional_number(std::string const& key, Range range) {
  auto const* const node = read(*state_, path_, key);
  if (!node) return std::nullopt;
  std::string const broken = node->is_number() ? broken_rule(node->as_double(), range) : wrong_kind("a number", *node);
  if (!broken.empty()) {
    problem(key, broken);
    return std::nullopt;
  }
  use(*state_, path_, key, toml_text(node->as_double()));
  return node->as_double();
}

double SetupTable::number(std::string const& key, double fallback, Range range) {
  double const value = optional_number(key, range).value_or(fallback);
  use(*state_, path_, key, toml_text(value));
  return value;
}

double SetupTable::quantity(std::string const& key, double fallback, double unit, Range range) {
  return number(key, in_unit(fallback, unit), range) * unit;
}

Vec2d SetupTable::quantities(std::string const& key, Vec2d fallback, double unit, Range range) {
  auto const v = numbers(key, {in_unit(fallback.x, unit), in_unit(fallback.y, unit)}, 2, range);
  return v.size() == 2 ? Vec2d{v[0] * unit, v[1] * unit} : fallback;
}

Vec3d SetupTable::quantities(std::string const& key, Vec3d fallback, double unit, Range range) {
  auto const v =
      numbers(key, {in_unit(fallback.x, unit), in_unit(fallback.y, unit), in_unit(fallback.z, unit)}, 3, range);
  return v.size() == 3 ? Vec3d{v[0] * unit, v[1] * unit, v[2] * unit} : fallback;
}

double SetupTable::required_number(std::string const& key, Range range) {
  if (!has(key)) problem(key, "is missing; give a number");
  return optional_number(key, range).value_or(harmless(range));
}

std::optional<double> SetupTable::number_or_auto(std::string const& key, Range range) {
  return number_or_word(key, {std::nullopt, "auto"}, {"auto"}, range).number;
}

SetupTable::NumberOrWord SetupTable::number_or_word(std::string const& key, NumberOrWord fallback,
                                                    std::vector<std::string> const& words, Range range) {
  auto const* const node = read(*state_, path_, key);
  NumberOrWord value = std::move(fallback);
  if (node && node->kind == Kind::text && std::find(words.begin(), words.end(), node->text) != words.end()) {
    value = {std::nullopt, node->text};
  } else if (node && node->is_number() && broken_rule(node->as_double(), range).empty()) {
    value = {node->as_double(), {}};
  } else if (node && node->is_number()) {
    problem(key, broken_rule(node->as_double(), range));
  } else if (node) {
    std::string message = "must be a number or " + quoted_list(words);
    if (node->kind == Kind::text) {
      if (auto const nearest = nearest_name(node->text, words)) message += "; did you mean \"" + *nearest + "\"?";
    } else {
      message += " (it is " + kind_name(*node) + ')';
    }
    problem(key, message);
  }
  use(*state_, path_, key, value.number ? toml_text(*value.number) : toml_text(std::string_view(value.word)));
  return value;
}

long long SetupTable::integer(std::string const& key, long long fallback, long long low, long long high) {
  auto const* const node = read(*state_, path_, key);
  long long value = fallback;
  if (node && node->kind != Kind::integer) {
    problem(key, wrong_integer(*node));
  } else if (node && (node->integer < low || node->integer > high)) {
    problem(key, between(low, high));
  } else if (node) {
    value = node->integer;
  }
  use(*state_, path_, key, std::to_string(value));
  return value;
}

long long SetupTable::required_integer(std::string const& key, long long low, long long high) {
  if (!has(key)) problem(key, "is missing; give a whole number");
  return integer(key, std::clamp(1LL, low, high), low, high);
}

bool SetupTable::boolean(std::string const& key, bool fallback) {
  auto const* const node = read(*state_, path_, key);
  if (node && node->kind != Kind::boolean) problem(key, wrong_kind("true or false", *node));
  bool const value = node && node->kind == Kind::boolean ? node->boolean : fallback;
  use(*state_, path_, key, boolean_text(value));
  return value;
}

std::string SetupTable::text(std::string const& key, std::string const& fallback) {
  auto const* const node = read(*state_, path_, key);
  if (node && node->kind != Kind::text) problem(key, wrong_kind("a text", *node) + "; put it in quotes");
  std::string const value = node && node->kind == Kind::text ? node->text : fallback;
  use(*state_, path_, key, toml_text(std::string_view(value)));
  return value;
}

std::string SetupTable::required_text(std::string const& key) {
  if (!has(key)) problem(key, "is missing; give a text in quotes");
  return text(key, "");
}

std::string SetupTable::word(std::string const& key, std::string const& fallback,
                             std::vector<std::string> const& words) {
  auto const* const node = read(*state_, path_, key);
  std::string value = fallback;
  if (node && node->kind != Kind::text) {
    problem(key, "must be " + quoted_list(words) + " (it is " + kind_name(*node) + ')');
  } else if (node && std::find(words.begin(), words.end(), node->text) == words.end()) {
    problem(key, wrong_word(node->text, words));
  } else if (node) {
    value = node->text;
  }
  use(*state_, path_, key, toml_text(std::string_view(value)));
  return value;
}

std::string SetupTable::kind_word(std::string const& key, std::string const& fallback,
                                  std::vector<std::string> const& words) {
  std::size_t const problems = state_->problems.size();
  std::string value = word(key, fallback, words);
  if (state_->problems.size() > problems) excuse();
  return value;
}

void SetupTable::excuse() { state_->record_of(path_).excused = true; }

std::string SetupTable::required_word(std::string const& key, std::vector<std::string> const& words) {
  if (!has(key)) problem(key, "is missing; give " + quoted_list(words));
  return word(key, words.empty() ? "" : words.front(), words);
}

std::string SetupTable::required_path(std::string const& key) {
  bool const present_here = has(key);
  if (!present_here) problem(key, "is missing; give a file name in quotes");
  std::string const written = text(key, "");
  if (written.empty()) {
    if (present_here && is_string(key)) problem(key, "must not be empty; give a file name");
    return {};
  }
  std::string const path = state_->absolute_name(*state_->find(below(path_, key)));
  state_->files.push_back({below(path_, key), path});
  use(*state_, path_, key, toml_text(std::string_view(path)));
  return path;
}

std::vector<std::string> SetupTable::path_list(std::string const& key) {
  auto const objection = [](SetupNode const& element) -> std::string {
    if (element.kind != Kind::text) return wrong_kind("a file name in quotes", element);
    return element.text.empty() ? "must not be empty; give a file name" : "";
  };
  auto const* const array = read_array(*this, read(*state_, path_, key), key, "file names in quotes", 0,
                                       std::numeric_limits<std::size_t>::max(), objection);
  if (!array) return {};
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < array->elements.size(); ++i) {
    paths.push_back(state_->absolute_name(array->elements[i]));
    state_->files.push_back({below(below(path_, key), '[' + std::to_string(i) + ']'), paths.back()});
  }
  use(*state_, path_, key,
      array_text(paths, [](std::string const& path) { return toml_text(std::string_view(path)); }));
  return paths;
}

std::vector<double> SetupTable::numbers(std::string const& key, std::vector<double> const& fallback, std::size_t count,
                                        Range range) {
  return number_list(key, fallback, count, count, range);
}

std::vector<double> SetupTable::number_list(std::string const& key, std::vector<double> const& fallback,
                                            std::size_t at_least, std::size_t at_most, Range range) {
  auto const objection = [&](SetupNode const& element) {
    return element.is_number() ? broken_rule(element.as_double(), range) : wrong_kind("a number", element);
  };
  auto const* const array = read_array(*this, read(*state_, path_, key), key, "numbers", at_least, at_most, objection);
  std::vector<double> values = array ? std::vector<double>{} : fallback;
  if (array) {
    for (auto const& element : array->elements) values.push_back(element.as_double());
  }
  use(*state_, path_, key, array_text(values, [](double value) { return toml_text(value); }));
  return values;
}

std::vector<long long> SetupTable::integers(std::string const& key, std::vector<long long> const& fallback,
                                            std::size_t at_least, std::size_t at_most, long long low, long long high) {
  auto const objection = [&](SetupNode const& element) {
    if (element.kind != Kind::integer) return wrong_integer(element);
    return element.integer < low || element.integer > high ? between(low, high) : std::string();
  };
  auto const* const array =
      read_array(*this, read(*state_, path_, key), key, "whole numbers", at_least, at_most, objection);
  std::vector<long long> values = array ? std::vector<long long>{} : fallback;
  if (array) {
    for (auto const& element : array->elements) values.push_back(element.integer);
  }
  use(*state_, path_, key, array_text(values, [](long long value) { return std::to_string(value); }));
  return values;
}

std::vector<bool> SetupTable::booleans(std::string const& key, std::vector<bool> const& fallback, std::size_t count) {
  auto const objection = [](SetupNode const& element) {
    return element.kind == Kind::boolean ? std::string() : wrong_kind("true or false", element);
  };
  auto const* const array =
      read_array(*this, read(*state_, path_, key), key, "times true or false", count, count, objection);
  std::vector<bool> values = array ? std::vector<bool>{} : fallback;
  if (array) {
    for (auto const& element : array->elements) values.push_back(element.boolean);
  }
  use(*state_, path_, key, array_text(values, boolean_text));
  return values;
}

void SetupTable::resolve(std::string const& key, double value) { settle(*state_, path_, key, toml_text(value)); }

void SetupTable::resolve(std::string const& key, long long value) {
  settle(*state_, path_, key, std::to_string(value));
}

void SetupTable::resolve(std::string const& key, std::vector<double> const& values) {
  settle(*state_, path_, key, array_text(values, [](double value) { return toml_text(value); }));
}

void SetupTable::resolve(std::string const& key, std::string const& word) {
  settle(*state_, path_, key, toml_text(word));
}

void SetupTable::pass_over(std::string const& key) { read(*state_, path_, key); }

void SetupTable::refuse(std::string const& key, std::string const& reason) {
  if (!has(key)) return;
  read(*state_, path_, key);
  problem(key, reason);
}

void SetupTable::problem(std::string const& key, std::string const& message) {
  auto const path = key.empty() ? path_ : below(path_, key);
  auto const* const node = state_->find(path);
  std::string text = key.empty() ? (path_.empty() ? "setup" : '[' + dotted_path(path_) + ']') : dotted_path(path);
  if (node && !key.empty()) {
    constexpr std::size_t longest = 60;
    std::string const value = toml_text(*node);
    text += " = " + (value.size() <= longest ? value : value.substr(0, longest - 3) + "...");
  } else if (!key.empty()) {
    auto const* const entry = state_->record_of(path_).find(key);
    if (entry && !entry->value.empty()) text += " = " + entry->value + " (default)";
  }
  state_->problems.push_back({where(key), text + ": " + message});
}

std::string SetupTable::where(std::string const& key) const {
  return state_->where(key.empty() ? path_ : below(path_, key));
}

}  // namespace gladstone
