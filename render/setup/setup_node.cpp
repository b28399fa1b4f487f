#include "render/setup/setup_node.h"

#include <toml++/toml.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "render/base/error.h"

namespace gladstone::inline setup {
namespace {

SetupPlace place_of(toml::source_region const& region) {
  return {static_cast<int>(region.begin.line), static_cast<int>(region.begin.column), {}};
}

template <class Date>
std::string date_text(Date const& date) {
  std::ostringstream text;
  text << date;
  return text.str();
}

SetupNode converted(toml::node const& source) {
  SetupNode node;
  node.place = place_of(source.source());
  using Kind = SetupNode::Kind;
  if (auto const* table = source.as_table()) {
    node.kind = Kind::table;
    for (auto&& [key, value] : *table) {
      auto& member = node.members.emplace_back(SetupMember{std::string(key.str()), converted(value)}).value;
      if (key.source().begin.line > 0) member.place = place_of(key.source());
    }
  } else if (auto const* array = source.as_array()) {
    node.kind = Kind::array;
    for (auto const& element : *array) node.elements.push_back(converted(element));
  } else if (auto const* text = source.as_string()) {
    node.kind = Kind::text;
    node.text = text->get();
  } else if (auto const* integer = source.as_integer()) {
    node.kind = Kind::integer;
    node.integer = integer->get();
  } else if (auto const* number = source.as_floating_point()) {
    node.kind = Kind::number;
    node.number = number->get();
  } else if (auto const* boolean = source.as_boolean()) {
    node.kind = Kind::boolean;
    node.boolean = boolean->get();
  } else {
    node.kind = Kind::date;
    if (auto const* date = source.as_date()) node.text = date_text(date->get());
    if (auto const* time = source.as_time()) node.text = date_text(time->get());
    if (auto const* date_time = source.as_date_time()) node.text = date_text(date_time->get());
  }
  return node;
}

}  // namespace

SetupNode const* SetupNode::find(std::string const& key) const {
  if (kind != Kind::table) return nullptr;
  for (auto const& [name, node] : members) {
    if (name == key) return &node;
  }
  return nullptr;
}

SetupNode* SetupNode::find(std::string const& key) { return const_cast<SetupNode*>(std::as_const(*this).find(key)); }

namespace {

/// Returns the remedy for the usual cause of a parser error; may be empty.
std::string cure(std::string_view complaint) {
  auto const says = [&](char const* words) { return complaint.find(words) != std::string_view::npos; };
  if (says("parsing boolean") || says("determine value type")) return "; put texts in quotes";
  if (says("saw ','")) return "; write a number with a decimal point, several values in brackets";
  if (says("cannot redefine")) return "; name it once, with all of its keys";
  if (says("expected value")) return "; give a value or remove the key";
  return "";
}

/// Returns the position after the closing quotes of the string that begins at `at`, or the end of the text.
std::size_t end_of_quotes(std::string_view text, std::size_t at) {
  char const quote = text[at];
  std::string_view const three = quote == '"' ? "\"\"\"" : "'''";
  bool const several_lines = text.substr(at).starts_with(three);
  for (std::size_t i = at + (several_lines ? 3 : 1); i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (several_lines && text.substr(i).starts_with(three)) {
      std::size_t end = i + 3;  // up to two further quotes belong to the string (TOML 1.0)
      while (end < i + 5 && end < text.size() && text[end] == quote) ++end;
      return end;
    } else if (!several_lines && (text[i] == quote || text[i] == '\n')) {
      return i + 1;
    }
  }
  return text.size();
}

/// Returns the first location where a key has more parts, or brackets are nested deeper, than most_setup_depth. The
/// TOML library and the code that processes its result recurse once per level.
std::optional<SetupPlace> too_deep(std::string_view text) {
  std::size_t dots = 0, brackets = 0;  // number of dots in the current key; depth of open brackets
  std::size_t line = 1, line_start = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char const c = text[i];
    if (c == '"' || c == '\'') {
      std::size_t const end = end_of_quotes(text, i);
      for (; i + 1 < end; ++i) {
        if (text[i] != '\n') continue;
        ++line;
        line_start = i + 1;
      }
      if (text[i] != '\n') continue;
    } else if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      if (i == text.size()) break;
    }
    if (text[i] == '.') {
      ++dots;
    } else if (std::string_view("\n=,[]{}").find(text[i]) != std::string_view::npos) {
      dots = 0;
      if (text[i] == '[' || text[i] == '{') ++brackets;
      if ((text[i] == ']' || text[i] == '}') && brackets > 0) --brackets;
    }
    if (dots >= most_setup_depth || brackets > most_setup_depth) {
      return SetupPlace{static_cast<int>(line), static_cast<int>(i - line_start) + 1, {}};
    }
    if (text[i] == '\n') {
      ++line;
      line_start = i + 1;
    }
  }
  return std::nullopt;
}

}  // namespace

SetupNode parse_toml(std::string_view text, std::string const& name) {
  if (auto const deep = too_deep(text)) {
    throw SetupError({{name + ':' + std::to_string(deep->line) + ':' + std::to_string(deep->column),
                       "tables or arrays are nested more than " + std::to_string(most_setup_depth) +
                           " levels deep, which is more than any setup needs; write the intended key",
                       "", ErrorCode::syntax}});
  }
  try {
    SetupNode root = converted(toml::parse(text));
    root.place = {1, 1, {}};
    return root;
  } catch (toml::parse_error const& error) {
    auto const begin = error.source().begin;
    throw SetupError(
        {{name + ':' + std::to_string(begin.line) + ':' + std::to_string(begin.column),
          "is not TOML: " + std::string(error.description()) + cure(error.description()), "", ErrorCode::syntax}});
  }
}

std::optional<SetupNode> parse_toml_value(std::string_view text) {
  if (too_deep(text)) return std::nullopt;
  try {
    toml::table const table = toml::parse("value = " + std::string(text));
    if (table.size() != 1) return std::nullopt;
    return converted(table.begin()->second);
  } catch (toml::parse_error const&) {
    return std::nullopt;
  }
}

SetupNode setup_text(std::string text) {
  SetupNode node;
  node.kind = SetupNode::Kind::text;
  node.text = std::move(text);
  return node;
}

SetupNode setup_number(double number) {
  SetupNode node;
  node.kind = SetupNode::Kind::number;
  node.number = number;
  return node;
}

SetupNode setup_integer(long long integer) {
  SetupNode node;
  node.kind = SetupNode::Kind::integer;
  node.integer = integer;
  return node;
}

SetupNode setup_array(std::vector<SetupNode> elements) {
  SetupNode node;
  node.kind = SetupNode::Kind::array;
  node.elements = std::move(elements);
  return node;
}

void set_source(SetupNode& node, std::shared_ptr<SetupSource const> const& source) {
  node.place.source = source;
  for (auto& element : node.elements) set_source(element, source);
  for (auto& member : node.members) set_source(member.value, source);
}

std::string kind_name(SetupNode const& node) {
  using Kind = SetupNode::Kind;
  switch (node.kind) {
    case Kind::text:
      return "a text";
    case Kind::integer:
      return "a whole number";
    case Kind::number:
      return "a number";
    case Kind::boolean:
      return "true or false";
    case Kind::date:
      return "a date";
    case Kind::array:
      return "an array";
    case Kind::table:
      return "a table";
  }
  return {};
}

}  // namespace gladstone::inline setup
