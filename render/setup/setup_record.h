#pragma once

#include <deque>
#include <string>
#include <vector>

namespace gladstone::inline setup {

/// Record of all keys that were requested from one table of a setup, in the order of the requests: which were read, and
/// the value used for each. Keys of the setup that are missing here are unknown; the record is also the source of the
/// resolved setup.
struct SetupRecord {
  struct Entry {
    std::string key;
    bool read = false;               ///< true: the value was requested, not only its existence
    bool resolved = false;           ///< true: `value` is final, e.g. computed for "auto"
    std::string value;               ///< TOML text of the value used; empty for tables and absent optional keys
    std::deque<SetupRecord> tables;  ///< records of sub-tables: one for a table, several for an array of tables
    bool array = false;              ///< true: `tables` is an array of tables
  };

  std::deque<Entry> entries;  ///< a deque, so that references to entries remain valid
  bool present = false;       ///< true: the table exists in the setup
  bool excused = false;       ///< true: unread keys of this table are not reported

  Entry& entry(std::string const& key);
  Entry const* find(std::string const& key) const;
  std::vector<std::string> keys() const;
  /// Returns the path ("lens", "medium.field", or "" for this table) of the first table here or below that has the key;
  /// "?" if there is none.
  std::string table_with(std::string const& key) const;
};

/// Formats a record as TOML: the keys of a table before its sub-tables, each in the order of reading.
std::string resolved_toml(SetupRecord const& root);

}  // namespace gladstone::inline setup
