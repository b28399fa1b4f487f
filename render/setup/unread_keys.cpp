#include "render/setup/unread_keys.h"

#include <algorithm>
#include <memory>
#include <tuple>

#include "render/base/nearest_name.h"
#include "render/base/text.h"

namespace gladstone::inline setup {
namespace {

/// Name of a table for messages: "[lens]", or "the setup" for the root.
std::string table_name(std::vector<std::string> const& path) {
  return path.empty() ? "the setup" : '[' + dotted_path(path) + ']';
}

/// Message about a key that was not read.
std::string unread_message(SetupDocument::State const& state, std::vector<std::string> const& table,
                           SetupRecord const& record, std::string const& key, SetupNode const& node) {
  bool const is_table = node.kind == SetupNode::Kind::table;
  auto const named = [&](std::string const& name) {
    auto path = table;
    path.push_back(name);
    return is_table ? '[' + excerpt(dotted_path(path)) + ']' : '"' + excerpt(name) + '"';
  };
  std::string const place = is_table ? "" : " in " + table_name(table);
  if (record.find(key)) return named(key) + place + " has no effect with the other settings; remove it";

  std::string const message = "unknown " + std::string(is_table ? "table " : "key ") + named(key) + place;
  auto const known = record.keys();
  if (auto const nearest = nearest_name(key, known)) return message + "; did you mean " + named(*nearest) + '?';
  std::string const elsewhere = state.record.table_with(key);
  if (elsewhere != "?") {
    return message + "; it belongs " + (elsewhere.empty() ? "before the first table" : "in [" + elsewhere + ']');
  }
  if (known.empty()) return message + "; remove it (no keys are read here)";
  return message + "; known are " + quoted_list(known);
}

/// Key of a setup that was not read.
struct UnreadKey {
  std::shared_ptr<std::vector<std::string> const> table;
  SetupRecord const* record;
  SetupMember const* member;
};

/// Collects the keys below a table that were not read; skips tables whose unread keys are not reported
/// (SetupRecord::excused).
void collect_unread(SetupNode const& node, SetupRecord const& record, std::vector<std::string>& path,
                    std::vector<UnreadKey>& unread) {
  if (record.excused) return;
  std::shared_ptr<std::vector<std::string> const> table;
  for (auto const& member : node.members) {
    auto const& [key, value] = member;
    auto const* const entry = record.find(key);
    if (!entry || !entry->read) {
      if (!table) table = std::make_shared<std::vector<std::string> const>(path);
      unread.push_back({table, &record, &member});
      continue;
    }
    path.push_back(key);
    if (value.kind == SetupNode::Kind::table && !entry->tables.empty()) {
      collect_unread(value, entry->tables.front(), path, unread);
    } else if (value.kind == SetupNode::Kind::array) {
      for (std::size_t i = 0; i < std::min(value.elements.size(), entry->tables.size()); ++i) {
        path.push_back('[' + std::to_string(i) + ']');
        collect_unread(value.elements[i], entry->tables[i], path, unread);
        path.pop_back();
      }
    }
    path.pop_back();
  }
}

}  // namespace

std::size_t add_unread(SetupDocument::State& state) {
  std::vector<std::string> path;
  std::vector<UnreadKey> unread;
  collect_unread(state.root, state.record, path, unread);
  auto const place = [](UnreadKey const& one) {
    SetupPlace const& at = one.member->value.place;
    return std::tuple{!at.assignment.empty(), at.line, at.column};
  };
  std::stable_sort(unread.begin(), unread.end(),
                   [&](UnreadKey const& a, UnreadKey const& b) { return place(a) < place(b); });
  for (std::size_t i = 0; i < std::min(unread.size(), max_reported_problems); ++i) {
    auto const& [table, record, member] = unread[i];
    std::vector<std::string> path = *table;
    path.push_back(member->key);
    state.problems.push_back({state.where(member->value.place),
                              unread_message(state, *table, *record, member->key, member->value), dotted_path(path),
                              ErrorCode::unknown_key});
  }
  return unread.size();
}

}  // namespace gladstone::inline setup
