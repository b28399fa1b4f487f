#include <algorithm>
#include <charconv>
#include <set>
#include <string_view>
#include <tuple>

#include "render/base/text.h"
#include "render/setup/setup_state.h"
#include "render/setup/toml_text.h"
#include "render/setup/unread_keys.h"

namespace gladstone::inline setup {
namespace {

/// Sort key of a location "file:line:column"; --set locations come after all lines.
std::tuple<int, int, int> sort_key(std::string const& where) {
  if (where.starts_with("--set")) return {2, 0, 0};
  auto const last = where.rfind(':');
  auto const first = last == std::string::npos || last == 0 ? last : where.rfind(':', last - 1);
  if (last == std::string::npos || first == std::string::npos) return {1, 0, 0};
  int line = 0, column = 0;
  auto const* const text = where.data();
  bool const placed = std::from_chars(text + first + 1, text + last, line).ptr == text + last &&
                      std::from_chars(text + last + 1, text + where.size(), column).ptr == text + where.size();
  return placed ? std::tuple{0, line, column} : std::tuple{1, 0, 0};
}

void set_place(SetupNode& node, SetupPlace const& place) {
  node.place = place;
  for (auto& element : node.elements) set_place(element, place);
  for (auto& member : node.members) set_place(member.value, place);
}

/// Sorts the keys of all tables, as the TOML parser does.
void sort_keys(SetupNode& node) {
  std::stable_sort(node.members.begin(), node.members.end(),
                   [](SetupMember const& a, SetupMember const& b) { return a.key < b.key; });
  for (auto& element : node.elements) sort_keys(element);
  for (auto& member : node.members) sort_keys(member.value);
}

/// Returns the setup as written, with absolute file names.
SetupNode absolute_root(SetupDocument::State const& state) {
  SetupDocument::State absolute;
  absolute.root = state.root;
  for (auto const& [path, name] : state.files) absolute.find(path)->text = name;
  return std::move(absolute.root);
}

std::vector<std::string> split_path(std::string const& text) {
  std::vector<std::string> steps{""};
  for (char const c : text) {
    if (c == '.') {
      steps.emplace_back();
    } else if (c != ' ' && c != '\t') {
      steps.back() += c;
    }
  }
  return steps;
}

}  // namespace

SetupDocument::SetupDocument(std::unique_ptr<State> state) : state_(std::move(state)) {}
SetupDocument::SetupDocument(SetupDocument&&) noexcept = default;
SetupDocument& SetupDocument::operator=(SetupDocument&&) noexcept = default;
SetupDocument::~SetupDocument() = default;

SetupDocument SetupDocument::from_text(std::string_view text, std::string const& name, std::string const& folder) {
  auto state = std::make_unique<State>();
  state->name = name;
  state->folder = folder;
  state->root = parse_toml(text, name);
  state->record.present = true;
  return SetupDocument(std::move(state));
}

void SetupDocument::override_key(std::string const& assignment) {
  std::string const where = "--set " + excerpt(assignment, longest_assignment);
  auto const equals = assignment.find('=');
  if (equals == std::string::npos) {
    add_problem({where, "has no \"=\"; write key.path=value", "", ErrorCode::syntax});
    return;
  }
  auto const path = split_path(assignment.substr(0, equals));
  if (std::find(path.begin(), path.end(), "") != path.end()) {
    add_problem({where, "has an empty key; write key.path=value", "", ErrorCode::syntax});
    return;
  }
  if (path.size() > most_setup_depth) {
    add_problem(where, "has a key of " + std::to_string(path.size()) +
                           " parts, which is more than any setup needs; write the intended key");
    return;
  }
  std::string const text = assignment.substr(equals + 1);
  if (text.find_first_not_of(" \t") == std::string::npos) {
    add_problem({where, "has no value; write key.path=value", dotted_path(path), ErrorCode::syntax});
    return;
  }
  SetupNode value;
  if (auto parsed = parse_toml_value(text)) {
    value = std::move(*parsed);
  } else {
    value.kind = SetupNode::Kind::text;
    value.text = text;
  }
  set_place(value, {0, 0, assignment});

  // Find the table, creating missing ones.
  SetupNode* table = &state_->root;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    SetupNode* next = table->find(path[i]);
    if (!next) {
      next = &table->members.emplace_back(SetupMember{path[i], SetupNode{}}).value;
      next->place.assignment = assignment;
    }
    if (next->kind != SetupNode::Kind::table) {
      std::vector<std::string> const here(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      bool const array = next->kind == SetupNode::Kind::array;
      add_problem({where,
                   dotted_path(here) + " is " + kind_name(*next) + ", not a table" +
                       (array ? "; change its elements in the file" : "; set a key of a table"),
                   dotted_path(path), ErrorCode::wrong_type});
      return;
    }
    table = next;
  }
  if (SetupNode* const old = table->find(path.back())) {
    *old = std::move(value);
  } else {
    table->members.push_back({path.back(), std::move(value)});
  }
}

void SetupDocument::set(std::vector<std::string> const& path, SetupNode const& value) {
  SetupNode* table = &state_->root;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    SetupNode* next = table->find(path[i]);
    if (!next) {
      next = &table->members.emplace_back(SetupMember{path[i], SetupNode{}}).value;
      next->place = value.place;
    }
    // An array of one table is treated as that table.
    if (next->kind == SetupNode::Kind::array && next->elements.size() == 1) next = &next->elements.front();
    if (next->kind != SetupNode::Kind::table) {
      std::vector<std::string> const here(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      add_problem({state_->where(value.place),
                   dotted_path(path) + ": " + dotted_path(here) + " is " + kind_name(*next) + ", not a table",
                   dotted_path(path), ErrorCode::wrong_type});
      return;
    }
    table = next;
  }
  if (SetupNode* const old = table->find(path.back())) {
    *old = value;
  } else {
    table->members.push_back({path.back(), value});
  }
}

SetupNode const* SetupDocument::find(std::vector<std::string> const& path) const {
  SetupNode const* node = &state_->root;
  for (auto const& step : path) {
    if (node->kind == SetupNode::Kind::array && node->elements.size() == 1) node = &node->elements.front();
    node = node->find(step);
    if (!node) return nullptr;
  }
  return node;
}

void SetupDocument::remove(std::vector<std::string> const& path) {
  auto* const table = const_cast<SetupNode*>(find({path.begin(), path.end() - 1}));
  if (!table) return;
  auto& members = table->kind == SetupNode::Kind::array && table->elements.size() == 1 ? table->elements.front().members
                                                                                       : table->members;
  std::erase_if(members, [&path](SetupMember const& member) { return member.key == path.back(); });
}

SetupTable SetupDocument::root() { return SetupTable(state_.get(), {}); }

SetupTable SetupDocument::reread(std::string const& key) {
  state_->record.entry(key).tables.clear();
  std::erase_if(state_->files, [&key](SetupFileName const& file) { return file.path.front() == key; });
  return root().table(key);
}

void SetupDocument::add_problem(SetupProblem problem) { state_->problems.push_back(std::move(problem)); }

bool SetupDocument::has_problems() const { return !state_->problems.empty(); }

bool SetupDocument::empty() const { return state_->root.members.empty(); }

void SetupDocument::finish() {
  auto& problems = state_->problems;
  std::size_t const before = problems.size();
  std::size_t const unread = add_unread(*state_);
  std::size_t const untold = unread - (problems.size() - before);
  std::stable_sort(problems.begin(), problems.end(),
                   [](SetupProblem const& a, SetupProblem const& b) { return sort_key(a.where) < sort_key(b.where); });
  std::set<std::pair<std::string_view, std::string_view>> known;
  std::vector<SetupProblem> distinct;
  for (auto const& problem : problems) {
    if (known.emplace(problem.where, problem.message).second) distinct.push_back(problem);
  }
  problems = distinct;
  if (!problems.empty()) throw SetupError(distinct, untold);
}

std::string SetupDocument::resolved() const { return resolved_toml(state_->record); }

std::string SetupDocument::written() const { return toml_document(absolute_root(*state_)); }

SetupDocument SetupDocument::unread() const {
  auto state = std::make_unique<State>();
  state->name = state_->name;
  state->folder = state_->folder;
  state->root = absolute_root(*state_);
  sort_keys(state->root);
  state->record.present = true;
  return SetupDocument(std::move(state));
}

std::vector<std::string> SetupDocument::file_names() const {
  std::vector<std::string> names;
  for (auto const& file : state_->files) names.push_back(file.absolute);
  return names;
}

std::vector<std::vector<std::string>> SetupDocument::file_keys() const {
  std::vector<std::vector<std::string>> keys;
  for (auto const& file : state_->files) keys.push_back(file.path);
  return keys;
}

void SetupDocument::name_files(std::vector<std::vector<std::string>> const& keys) {
  state_->files.clear();
  for (auto const& path : keys) {
    SetupNode* const node = state_->find(path);
    if (!node || node->kind != SetupNode::Kind::text || node->text.empty()) continue;
    node->text = state_->absolute_name(*node);
    state_->files.push_back({path, node->text});
  }
}

SetupDocument SetupDocument::copy() const { return SetupDocument(std::make_unique<State>(*state_)); }

std::string const& SetupDocument::folder() const { return state_->folder; }

}  // namespace gladstone::inline setup
