#pragma once

#include <deque>
#include <string>
#include <vector>

namespace gladstone {

/// What the readers of a setup asked of one table, in the order of asking: the keys it has, which of them were read,
/// and what each came to. It is the schema seen at work, from which unread keys are found and the resolved setup is
/// written.
struct SetupRecord {
  struct Entry {
    std::string key;
    bool read = false;               ///< asked for its value, not only for its presence
    bool resolved = false;           ///< `value` is final: what an "auto" came to
    std::string value;               ///< TOML text of the value used; empty for a table and for an absent optional key
    std::deque<SetupRecord> tables;  ///< one for a table, several for an array of tables
    bool array = false;              ///< `tables` were written as an array of tables
  };

  std::deque<Entry> entries;  ///< a deque, so that records keep their place
  bool present = false;       ///< the table is written in the setup
  bool excused = false;       ///< keys that nobody read are no mistakes here

  Entry& entry(std::string const& key);
  Entry const* find(std::string const& key) const;
  std::vector<std::string> keys() const;
  /// The path ("lens", "medium.field", "" for this table) of a table below here that knows `key`; nothing found: "?".
  std::string table_with(std::string const& key) const;
};

/// The record as TOML: the keys of a table before its sub-tables, each in the order of reading.
std::string resolved_toml(SetupRecord const& root);

}  // namespace gladstone
