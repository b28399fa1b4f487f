#include "render/setup/toml_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gladstone::inline setup {
namespace {

bool is_bare_key(std::string const& key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

void write_table(SetupNode const& table, std::string const& path, std::string& text) {
  for (auto const& [key, value] : table.members) {
    if (value.kind != SetupNode::Kind::table) text += toml_key(key) + " = " + toml_text(value) + '\n';
  }
  for (auto const& [key, value] : table.members) {
    if (value.kind != SetupNode::Kind::table) continue;
    std::string const name = path + (path.empty() ? "" : ".") + toml_key(key);
    text += (text.empty() ? "[" : "\n[") + name + "]\n";
    write_table(value, name, text);
  }
}

}  // namespace

std::string toml_key(std::string const& key) { return is_bare_key(key) ? key : toml_text(std::string_view(key)); }

std::string toml_text(std::string_view text) {
  std::string quoted = "\"";
  for (char const c : text) {
    auto const code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (c == '\n') {
      quoted += "\\n";
    } else if (c == '\t') {
      quoted += "\\t";
    } else if (code < 0x20 || code == 0x7f) {
      constexpr char digits[] = "0123456789abcdef";
      quoted += "\\u00";
      quoted += digits[code >> 4];
      quoted += digits[code & 15];
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string toml_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  char buffer[32];
  auto const end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  std::string text(buffer, end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string toml_text(SetupNode const& node) {
  using Kind = SetupNode::Kind;
  switch (node.kind) {
    case Kind::text:
      return toml_text(std::string_view(node.text));
    case Kind::integer:
      return std::to_string(node.integer);
    case Kind::number:
      return toml_text(node.number);
    case Kind::boolean:
      return node.boolean ? "true" : "false";
    case Kind::date:
      return node.text;
    case Kind::array: {
      std::string text;
      for (auto const& element : node.elements) text += (text.empty() ? "" : ", ") + toml_text(element);
      return '[' + text + ']';
    }
    case Kind::table:
      break;
  }
  std::string text;
  for (auto const& [key, value] : node.members) {
    text += (text.empty() ? " " : ", ") + toml_key(key) + " = " + toml_text(value);
  }
  return '{' + text + (text.empty() ? "}" : " }");
}

std::string toml_document(SetupNode const& node) {
  std::string text;
  write_table(node, "", text);
  return text;
}

}  // namespace gladstone::inline setup
