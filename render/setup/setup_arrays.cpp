#include <cstddef>
#include <limits>

#include "render/setup/setup_reading.h"
#include "render/setup/toml_text.h"

/// Array readers of SetupTable.
namespace gladstone::inline setup {
using namespace setup_reading;
namespace {

using Kind = SetupNode::Kind;

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

/// Problem of an element of an array; the text is empty if the element is valid.
struct Objection {
  std::string text;
  ErrorCode code = ErrorCode::wrong_type;
};

/// Returns an array if its number of elements is allowed and `objection` returns an empty text for each of them; else
/// adds a problem and returns null.
template <class Check>
SetupNode const* read_array(SetupTable& table, SetupNode const* node, std::string const& key, std::string const& wanted,
                            std::size_t at_least, std::size_t at_most, Check const& objection) {
  if (!node) return nullptr;
  std::string const form = "an array of " + counted(at_least, at_most) + ' ' + wanted;
  if (node->kind != Kind::array) {
    std::string const bracketed = node->kind == Kind::text ? '[' + node->text + ']' : std::string();
    bool const brackets_are_missing = !bracketed.empty() && parse_toml_value(bracketed);
    table.problem(key, wrong_kind(form, *node) + (brackets_are_missing ? "; write " + bracketed : ""),
                  ErrorCode::wrong_type);
    return nullptr;
  }
  std::size_t const count = node->elements.size();
  if (count < at_least || count > at_most) {
    table.problem(key, "must be " + form + " (it has " + std::to_string(count) + ')', ErrorCode::wrong_type);
    return nullptr;
  }
  for (std::size_t i = 0; i < count; ++i) {
    Objection const broken = objection(node->elements[i]);
    if (broken.text.empty()) continue;
    table.problem(key, "value " + std::to_string(i + 1) + ", " + toml_text(node->elements[i]) + ", " + broken.text,
                  broken.code);
    return nullptr;
  }
  return node;
}

}  // namespace

Vec2d SetupTable::quantities(std::string const& key, Vec2d fallback, double unit, Range range) {
  auto const v = numbers(key, {in_unit(fallback.x, unit), in_unit(fallback.y, unit)}, 2, range);
  return v.size() == 2 ? Vec2d{v[0] * unit, v[1] * unit} : fallback;
}

Vec3d SetupTable::quantities(std::string const& key, Vec3d fallback, double unit, Range range) {
  auto const v =
      numbers(key, {in_unit(fallback.x, unit), in_unit(fallback.y, unit), in_unit(fallback.z, unit)}, 3, range);
  return v.size() == 3 ? Vec3d{v[0] * unit, v[1] * unit, v[2] * unit} : fallback;
}

std::vector<std::string> SetupTable::path_list(std::string const& key, std::size_t at_least) {
  auto const objection = [](SetupNode const& element) -> Objection {
    if (element.kind != Kind::text) return {wrong_kind("a file name in quotes", element)};
    return {element.text.empty() ? "must not be empty; give a file name" : "", ErrorCode::invalid_value};
  };
  auto const* const array = read_array(*this, read(*state_, path_, key), key, "file names in quotes", at_least,
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
  auto const objection = [&](SetupNode const& element) -> Objection {
    if (!element.is_number()) return {wrong_kind("a number", element)};
    return {broken_rule(element.as_double(), range), ErrorCode::out_of_range};
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
  auto const objection = [&](SetupNode const& element) -> Objection {
    if (element.kind != Kind::integer) return {wrong_integer(element)};
    if (element.integer < low || element.integer > high) return {between(low, high), ErrorCode::out_of_range};
    return {};
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
  auto const objection = [](SetupNode const& element) -> Objection {
    return {element.kind == Kind::boolean ? std::string() : wrong_kind("true or false", element)};
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

void SetupTable::resolve(std::string const& key, std::vector<double> const& values) {
  settle(*state_, path_, key, array_text(values, [](double value) { return toml_text(value); }));
}

}  // namespace gladstone::inline setup
