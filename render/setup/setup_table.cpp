#include "render/setup/setup_table.h"

#include <algorithm>

#include "render/base/nearest_name.h"
#include "render/setup/setup_reading.h"
#include "render/setup/toml_text.h"

namespace gladstone::inline setup {
using namespace setup_reading;
namespace {

using Kind = SetupNode::Kind;

}  // namespace

SetupTable::SetupTable(SetupDocument::State* state, std::vector<std::string> path)
    : state_(state), path_(std::move(path)) {
  state_->find_or_create_record(path_).present = present();
}

SetupTable SetupTable::table(std::string const& key) {
  auto const* const node = read(*state_, path_, key);
  if (node && node->kind == Kind::array) {
    problem(key, "must be one table; write [" + dotted_path(below(path_, key)) + "] once, in single brackets",
            ErrorCode::wrong_type);
  } else if (node && node->kind != Kind::table) {
    problem(key, wrong_kind("a table", *node) + "; write [" + dotted_path(below(path_, key)) + "] and its keys below",
            ErrorCode::wrong_type);
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
    problem(key,
            "must be a table or an array of tables; write [" + dotted_path(path) + "] or [[" + dotted_path(path) + "]]",
            ErrorCode::wrong_type);
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
    problem(key, broken, node->is_number() ? ErrorCode::out_of_range : ErrorCode::wrong_type);
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

double SetupTable::required_number(std::string const& key, Range range) {
  if (!has(key)) problem(key, "is missing; give a number", ErrorCode::missing_key);
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
    problem(key, broken_rule(node->as_double(), range), ErrorCode::out_of_range);
  } else if (node) {
    std::string message = "must be a number or " + quoted_list(words);
    if (node->kind == Kind::text) {
      if (auto const nearest = nearest_name(node->text, words)) message += "; did you mean \"" + *nearest + "\"?";
    } else {
      message += " (it is " + kind_name(*node) + ')';
    }
    problem(key, message, node->kind == Kind::text ? ErrorCode::unknown_choice : ErrorCode::wrong_type);
  }
  use(*state_, path_, key, value.number ? toml_text(*value.number) : toml_text(std::string_view(value.word)));
  return value;
}

long long SetupTable::integer(std::string const& key, long long fallback, long long low, long long high) {
  auto const* const node = read(*state_, path_, key);
  long long value = fallback;
  if (node && node->kind != Kind::integer) {
    problem(key, wrong_integer(*node), ErrorCode::wrong_type);
  } else if (node && (node->integer < low || node->integer > high)) {
    problem(key, between(low, high), ErrorCode::out_of_range);
  } else if (node) {
    value = node->integer;
  }
  use(*state_, path_, key, std::to_string(value));
  return value;
}

long long SetupTable::required_integer(std::string const& key, long long low, long long high) {
  if (!has(key)) problem(key, "is missing; give a whole number", ErrorCode::missing_key);
  return integer(key, std::clamp(1LL, low, high), low, high);
}

bool SetupTable::boolean(std::string const& key, bool fallback) {
  auto const* const node = read(*state_, path_, key);
  if (node && node->kind != Kind::boolean) problem(key, wrong_kind("true or false", *node), ErrorCode::wrong_type);
  bool const value = node && node->kind == Kind::boolean ? node->boolean : fallback;
  use(*state_, path_, key, boolean_text(value));
  return value;
}

std::string SetupTable::text(std::string const& key, std::string const& fallback) {
  auto const* const node = read(*state_, path_, key);
  if (node && node->kind != Kind::text)
    problem(key, wrong_kind("a text", *node) + "; put it in quotes", ErrorCode::wrong_type);
  std::string const value = node && node->kind == Kind::text ? node->text : fallback;
  use(*state_, path_, key, toml_text(std::string_view(value)));
  return value;
}

std::string SetupTable::word(std::string const& key, std::string const& fallback,
                             std::vector<std::string> const& words) {
  auto const* const node = read(*state_, path_, key);
  std::string value = fallback;
  if (node && node->kind != Kind::text) {
    problem(key, "must be " + quoted_list(words) + " (it is " + kind_name(*node) + ')', ErrorCode::wrong_type);
  } else if (node && std::find(words.begin(), words.end(), node->text) == words.end()) {
    problem(key, wrong_word(node->text, words), ErrorCode::unknown_choice);
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
  if (state_->problems.size() > problems) suppress_unread_keys();
  return value;
}

void SetupTable::suppress_unread_keys() { state_->find_or_create_record(path_).excused = true; }

std::string SetupTable::required_word(std::string const& key, std::vector<std::string> const& words) {
  if (!has(key)) problem(key, "is missing; give " + quoted_list(words), ErrorCode::missing_key);
  return word(key, words.empty() ? "" : words.front(), words);
}

std::string SetupTable::required_path(std::string const& key) {
  bool const present_here = has(key);
  if (!present_here) problem(key, "is missing; give a file name in quotes", ErrorCode::missing_key);
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

void SetupTable::resolve(std::string const& key, double value) { settle(*state_, path_, key, toml_text(value)); }

void SetupTable::resolve(std::string const& key, long long value) {
  settle(*state_, path_, key, std::to_string(value));
}

void SetupTable::resolve(std::string const& key, std::string const& word) {
  settle(*state_, path_, key, toml_text(word));
}

void SetupTable::mark_as_read(std::string const& key) { read(*state_, path_, key); }

void SetupTable::refuse(std::string const& key, std::string const& reason) {
  if (!has(key)) return;
  read(*state_, path_, key);
  problem(key, reason);
}

void SetupTable::problem(std::string const& key, std::string const& message, ErrorCode code) {
  auto const path = key.empty() ? path_ : below(path_, key);
  auto const* const node = state_->find(path);
  std::string text = key.empty() ? (path_.empty() ? "setup" : '[' + dotted_path(path_) + ']') : dotted_path(path);
  if (node && !key.empty()) {
    constexpr std::size_t longest = 60;
    std::string const value = toml_text(*node);
    text += " = " + (value.size() <= longest ? value : value.substr(0, longest - 3) + "...");
  } else if (!key.empty()) {
    auto const* const entry = state_->find_or_create_record(path_).find(key);
    if (entry && !entry->value.empty()) text += " = " + entry->value + " (default)";
  }
  state_->problems.push_back({where(key), text + ": " + message, dotted_path(path), code});
}

std::string SetupTable::where(std::string const& key) const {
  return state_->where(key.empty() ? path_ : below(path_, key));
}

}  // namespace gladstone::inline setup
