#include "render/setup/setup_state.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "render/base/text.h"
#include "render/setup/toml_text.h"

namespace gladstone::inline setup {
namespace {

bool is_index(std::string const& step) { return step.size() > 2 && step.front() == '[' && step.back() == ']'; }

std::size_t index_of(std::string const& step) {
  std::size_t index = 0;
  std::from_chars(step.data() + 1, step.data() + step.size() - 1, index);
  return index;
}

}  // namespace

SetupNode const* SetupDocument::State::find(std::vector<std::string> const& path) const {
  SetupNode const* node = &root;
  for (auto const& step : path) {
    if (is_index(step) && node->kind == SetupNode::Kind::array) {
      std::size_t const index = index_of(step);
      node = index < node->elements.size() ? &node->elements[index] : nullptr;
    } else {
      node = node->find(step);
    }
    if (!node) return nullptr;
  }
  return node;
}

SetupRecord& SetupDocument::State::find_or_create_record(std::vector<std::string> const& path) {
  SetupRecord* table = &record;
  for (std::size_t i = 0; i < path.size(); ++i) {
    auto& entry = table->entry(path[i]);
    entry.read = true;
    bool const element = i + 1 < path.size() && is_index(path[i + 1]);
    std::size_t const index = element ? index_of(path[++i]) : 0;
    if (element) entry.array = true;
    while (entry.tables.size() <= index) entry.tables.emplace_back();
    table = &entry.tables[index];
  }
  return *table;
}

std::string SetupDocument::State::where(SetupPlace const& place) const {
  if (!place.assignment.empty()) return "--set " + excerpt(place.assignment, longest_assignment);
  std::string const& file = place.source ? place.source->name : name;
  return file + ':' + std::to_string(std::max(place.line, 1)) + ':' + std::to_string(std::max(place.column, 1));
}

std::string SetupDocument::State::where(std::vector<std::string> const& path) const {
  for (auto above = path;; above.pop_back()) {
    auto const* const node = find(above);
    if (node && (node->place.known() || above.empty())) return where(node->place);
  }
}

std::string SetupDocument::State::absolute_name(SetupNode const& text) const {
  namespace fs = std::filesystem;
  fs::path const place = text.place.source ? text.place.source->folder : folder;
  return fs::absolute(place / text.text).lexically_normal().string();
}

std::string dotted_path(std::vector<std::string> const& path) {
  std::string text;
  for (auto const& step : path) {
    if (!text.empty() && !is_index(step)) text += '.';
    text += is_index(step) ? step : toml_key(step);
  }
  return text;
}

}  // namespace gladstone::inline setup
