#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/base/error.h"
#include "render/base/vec.h"

namespace gladstone::inline setup {

class SetupTable;
struct SetupNode;

/// Setup file (TOML) during reading. It collects all problems, and records which keys were read and the value used for
/// each, given or default. The modules read their own tables through SetupTable.
class SetupDocument {
 public:
  /// Parses text.
  /// @param name    name of the text in messages
  /// @param folder  directory to which relative file names refer
  /// @throws SetupError if it is not TOML
  static SetupDocument from_text(std::string_view text, std::string const& name, std::string const& folder = ".");
  SetupDocument(SetupDocument&&) noexcept;
  SetupDocument& operator=(SetupDocument&&) noexcept;
  ~SetupDocument();

  /// Applies one `--set key.path=value`. The value is TOML, or plain text if it cannot be parsed as TOML (`--set
  /// lens.focus=medium`). Problems with the key are reported at "--set key.path=value".
  void override_key(std::string const& assignment);

  /// Sets the value at a path of keys, creating missing tables. Messages refer to the location of the value, and file
  /// names in it are relative to the directory of its source file.
  void set(std::vector<std::string> const& path, SetupNode const& value);
  /// Returns the value at a path of keys; null if there is none.
  SetupNode const* find(std::vector<std::string> const& path) const;
  /// Removes the value at a path of keys, if there is one.
  void remove(std::vector<std::string> const& path);

  /// Returns the root table. Tables are views: the document must outlive them.
  SetupTable root();
  /// Returns a table of the root as if it had not been read, so that its changed values can be read.
  SetupTable reread(std::string const& key);

  void add_problem(SetupProblem problem);
  void add_problem(std::string where, std::string message) { add_problem({std::move(where), std::move(message)}); }
  bool has_problems() const;
  /// Returns true if no key is set.
  bool empty() const;

  /// Completes reading: adds a problem for every key that was not read, with the most similar known key, and throws if
  /// there are any problems.
  /// @throws SetupError with all problems, in the order of their location
  void finish();

  /// Returns the resolved setup as TOML: every key that was read with the value used, including defaults, values
  /// computed for "auto" (SetupTable::resolve()), and absolute file names. It reads back to the same setup.
  std::string resolved() const;

  /// Returns the setup as written, as one TOML document without defaults; file names that were read are absolute.
  std::string written() const;

  /// Returns the document that parsing written() gives, except that messages still refer to the original file: its keys
  /// are sorted and unread, and it has no problems.
  SetupDocument unread() const;

  /// Returns the absolute names of the files read by required_path() and path_list().
  std::vector<std::string> file_names() const;
  /// Returns the keys of file_names() as paths from the root; "[2]" for an element of an array.
  std::vector<std::vector<std::string>> file_keys() const;
  /// Declares the texts at these keys to be file names and makes them absolute, as reading the setup would. Replaces
  /// the list of file_names(); keys that are absent or not texts are skipped.
  void name_files(std::vector<std::vector<std::string>> const& keys);

  /// Returns a copy of the document, including the record of the keys read.
  SetupDocument copy() const;

  /// Directory to which relative file names refer.
  std::string const& folder() const;

  struct State;

 private:
  explicit SetupDocument(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Allowed interval of a number, in the unit of its key. Both ends are included unless stated otherwise.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;   ///< `low` itself is excluded
  bool allow_inf = false;  ///< infinity is allowed

  static Range positive(double high = std::numeric_limits<double>::infinity()) { return {0.0, high, true, false}; }
  static Range at_least(double low, double high = std::numeric_limits<double>::infinity()) {
    return {low, high, false, false};
  }
  static Range any() { return {}; }
};

/// One table of a setup. Every reading function returns the value in the unit of its key (mm, um, deg ...) and records
/// the key as known and read. If the value is wrong, it adds a problem to the document and returns the fallback, so
/// that all problems are reported together. Functions without a fallback require the key; if it is missing, they add a
/// problem and return an allowed value. NaN is always refused, infinity unless the Range allows it. An integer is
/// accepted as a number; there are no other conversions.
class SetupTable {
 public:
  SetupTable(SetupDocument::State* state, std::vector<std::string> path);

  /// Returns the sub-table of that name; an empty one if it is absent, so that defaults apply.
  SetupTable table(std::string const& key);
  /// Returns the elements of an array of tables; a single table is an array of one, an absent key an empty array.
  std::vector<SetupTable> tables(std::string const& key);

  bool has(std::string const& key) const;
  bool is_string(std::string const& key) const;
  bool is_array(std::string const& key) const;
  bool is_table(std::string const& key) const;
  /// Returns true if the table exists in the file or is created by --set.
  bool present() const;

  double number(std::string const& key, double fallback, Range range = Range::any());
  double required_number(std::string const& key, Range range = Range::any());
  /// Reads a number and converts it to SI.
  /// @param fallback  default in SI; recorded in the key's own unit
  /// @param unit      size of the key's unit in SI
  /// @param range     allowed range in the key's own unit
  double quantity(std::string const& key, double fallback, double unit, Range range = Range::any());
  /// Reads an array of two or three numbers and converts it to SI, like quantity().
  Vec2d quantities(std::string const& key, Vec2d fallback, double unit, Range range = Range::any());
  Vec3d quantities(std::string const& key, Vec3d fallback, double unit, Range range = Range::any());
  std::optional<double> optional_number(std::string const& key, Range range = Range::any());
  /// Reads a number or the word "auto", which is also the default and returned as nullopt. The value computed for
  /// "auto" is recorded by resolve().
  std::optional<double> number_or_auto(std::string const& key, Range range = Range::any());
  /// Reads a number or one of several words; the result has exactly one of the two.
  struct NumberOrWord {
    std::optional<double> number;
    std::string word;
  };
  NumberOrWord number_or_word(std::string const& key, NumberOrWord fallback, std::vector<std::string> const& words,
                              Range range = Range::any());
  long long integer(std::string const& key, long long fallback, long long low, long long high);
  long long required_integer(std::string const& key, long long low, long long high);
  bool boolean(std::string const& key, bool fallback);
  std::string text(std::string const& key, std::string const& fallback);
  /// Reads one of a closed set of words; the problem lists them and the most similar one.
  std::string word(std::string const& key, std::string const& fallback, std::vector<std::string> const& words);
  /// Reads one of a closed set of words and returns the value assigned to it.
  template <class Choice>
  Choice choice(std::string const& key, Choice fallback, std::vector<std::pair<std::string, Choice>> const& choices) {
    std::vector<std::string> words;
    std::string chosen;
    for (auto const& [name, value] : choices) {
      words.push_back(name);
      if (value == fallback) chosen = name;
    }
    chosen = word(key, chosen, words);
    for (auto const& [name, value] : choices) {
      if (name == chosen) return value;
    }
    return fallback;
  }
  std::string required_word(std::string const& key, std::vector<std::string> const& words);
  /// Reads a file name and makes it absolute; it is relative to the directory of the file in which it is written.
  std::string required_path(std::string const& key);
  /// Reads an array of at least `at_least` file names and makes them absolute like required_path(); empty if the key is
  /// absent.
  std::vector<std::string> path_list(std::string const& key, std::size_t at_least = 0);

  /// Reads an array of exactly `count` numbers.
  std::vector<double> numbers(std::string const& key, std::vector<double> const& fallback, std::size_t count,
                              Range range = Range::any());
  /// Reads an array of `at_least` to `at_most` numbers.
  std::vector<double> number_list(std::string const& key, std::vector<double> const& fallback, std::size_t at_least,
                                  std::size_t at_most, Range range = Range::any());
  std::vector<long long> integers(std::string const& key, std::vector<long long> const& fallback, std::size_t at_least,
                                  std::size_t at_most, long long low, long long high);
  std::vector<bool> booleans(std::string const& key, std::vector<bool> const& fallback, std::size_t count);

  /// Records the final value of a key in the resolved setup, for "auto" or a default that depends on other keys.
  void resolve(std::string const& key, double value);
  void resolve(std::string const& key, long long value);
  void resolve(std::string const& key, std::vector<double> const& values);
  void resolve(std::string const& key, std::string const& word);

  /// Reads a word, like word(), that determines which other keys the table has. If it is wrong, unread keys of
  /// the table are not reported.
  std::string kind_word(std::string const& key, std::string const& fallback, std::vector<std::string> const& words);
  /// Suppresses the problems about unread keys of this table, since their meaning depends on a key that was wrong.
  void suppress_unread_keys();

  /// Marks a key, or the whole table of that name, as read, because it is read elsewhere.
  void mark_as_read(std::string const& key);

  /// Adds a problem if the key is present. @param reason  text of the problem, "is not available yet: thin lenses only"
  void refuse(std::string const& key, std::string const& reason);

  /// Adds a problem at this key, or at the table if the key is empty or absent.
  void problem(std::string const& key, std::string const& message, ErrorCode code = ErrorCode::invalid_value);
  /// Location of the key, or of the table if it is absent: "file:line:column" or "--set ...".
  std::string where(std::string const& key) const;

 private:
  SetupDocument::State* state_;
  std::vector<std::string> path_;
};

}  // namespace gladstone::inline setup
