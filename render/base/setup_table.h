#pragma once

#include <array>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/base/error.h"
#include "render/base/vec.h"

namespace gladstone {

class SetupTable;
struct SetupNode;

/// A setup file (TOML) being read: it collects every problem, remembers which keys were read and what each
/// key, given or default, came to. Rooms read their own tables through SetupTable.
class SetupDocument {
 public:
  /// Parses a file; a syntax error, a missing or an unreadable file is a SetupError.
  static SetupDocument from_file(std::string const& path);
  /// Parses text; `name` stands for the file in messages; relative file names are relative to `folder`.
  static SetupDocument from_text(std::string_view text, std::string const& name, std::string const& folder = ".");
  SetupDocument(SetupDocument&&) noexcept;
  SetupDocument& operator=(SetupDocument&&) noexcept;
  ~SetupDocument();

  /// Applies one `--set key.path=value`; the value is TOML, or a bare string where TOML finds none
  /// (`--set lens.focus=medium`). Problems with the key are reported at "--set key.path=value".
  void override_key(std::string const& assignment);

  /// Puts a value at a path of keys in place of what is there; tables on the way are made. In messages it stands where
  /// its own place says, and file names in it are relative to the folder of its own source.
  void set(std::vector<std::string> const& path, SetupNode const& value);
  /// The value at a path of keys; null where there is none.
  SetupNode const* find(std::vector<std::string> const& path) const;

  /// The root table. Tables are views: the document must outlive them.
  SetupTable root();

  void add_problem(std::string where, std::string message);
  bool has_problems() const;
  /// Whether no key at all is set.
  bool empty() const;

  /// Throws SetupError with all problems found so far, among them every key that nobody read, each with the nearest
  /// known key of that table.
  void finish();

  /// The setup as understood: every key that was read, with the value used, defaults written out, "auto" replaced by
  /// what SetupTable::resolve gave, file names absolute. Reads back to the same setup.
  std::string resolved() const;

  /// The setup as it is written, as one TOML document without defaults; file names that were read are absolute.
  std::string written() const;

  /// Absolute names of the files that were asked for by required_path and path_list.
  std::vector<std::string> file_names() const;
  /// Their keys, paths from the root; "[2]" for an element of an array.
  std::vector<std::vector<std::string>> file_keys() const;
  /// Takes the texts at these keys as the names of files, as reading the setup would find them, and makes them
  /// absolute; others are none.
  void name_files(std::vector<std::vector<std::string>> const& keys);

  /// The same document once more, with all that was read of it.
  SetupDocument copy() const;

  /// The folder that relative file names refer to.
  std::string const& folder() const;

  struct State;

 private:
  explicit SetupDocument(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Allowed interval of a number, in the unit of the key as written. Ends are included unless said otherwise.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;   ///< low itself is refused
  bool allow_inf = false;  ///< TOML's inf is a value, not a mistake

  static Range positive(double high = std::numeric_limits<double>::infinity()) { return {0.0, high, true, false}; }
  static Range at_least(double low, double high = std::numeric_limits<double>::infinity()) {
    return {low, high, false, false};
  }
  static Range any() { return {}; }
};

/// One table of a setup. Every reader returns the value as written in the key's own unit (mm, um, deg ...), records
/// the key as known and read, and on any mistake adds a problem to the document and returns the fallback, so that
/// reading goes on and all problems appear together. NaN is refused everywhere, inf unless the Range allows it.
/// A reader without fallback requires the key; where it is missing a problem is added and a harmless value returned.
/// An integer is accepted where a number is asked for; nothing else is converted.
class SetupTable {
 public:
  SetupTable(SetupDocument::State* state, std::vector<std::string> path);

  /// The table of that name; where it is absent an empty one, so that defaults apply.
  SetupTable table(std::string const& key);
  /// An array of tables, or a single table as an array of one, or nothing.
  std::vector<SetupTable> tables(std::string const& key);

  bool has(std::string const& key) const;
  bool is_string(std::string const& key) const;
  bool is_array(std::string const& key) const;
  bool is_table(std::string const& key) const;
  /// True where the table itself is written in the file (or by --set).
  bool present() const;

  double number(std::string const& key, double fallback, Range range = Range::any());
  double required_number(std::string const& key, Range range = Range::any());
  /// The same in SI. @param fallback in SI, too; written out in the key's own unit @param unit the size of that in SI
  /// @param range in the key's own unit
  double quantity(std::string const& key, double fallback, double unit, Range range = Range::any());
  Vec2d quantities(std::string const& key, Vec2d fallback, double unit, Range range = Range::any());
  Vec3d quantities(std::string const& key, Vec3d fallback, double unit, Range range = Range::any());
  std::optional<double> optional_number(std::string const& key, Range range = Range::any());
  /// A number or the word "auto" (nothing is returned for "auto", which is also the default). Use resolve() later.
  std::optional<double> number_or_auto(std::string const& key, Range range = Range::any());
  /// A number or one of some words; gives exactly one of the two.
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
  std::string required_text(std::string const& key);
  /// One of a closed set of words; the problem lists them and names the nearest.
  std::string word(std::string const& key, std::string const& fallback, std::vector<std::string> const& words);
  /// The same for what the words stand for.
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
  /// A file name, made absolute against the setup's folder.
  std::string required_path(std::string const& key);
  /// File names, made absolute likewise; none where the key is absent.
  std::vector<std::string> path_list(std::string const& key);

  std::vector<double> numbers(std::string const& key, std::vector<double> const& fallback, std::size_t count,
                              Range range = Range::any());
  /// Any count of numbers from `at_least` to `at_most`.
  std::vector<double> number_list(std::string const& key, std::vector<double> const& fallback, std::size_t at_least,
                                  std::size_t at_most, Range range = Range::any());
  std::vector<long long> integers(std::string const& key, std::vector<long long> const& fallback, std::size_t at_least,
                                  std::size_t at_most, long long low, long long high);
  std::vector<bool> booleans(std::string const& key, std::vector<bool> const& fallback, std::size_t count);

  /// Writes what an "auto", or a default that hangs on other keys, came to into the resolved setup.
  void resolve(std::string const& key, double value);
  void resolve(std::string const& key, long long value);
  void resolve(std::string const& key, std::vector<double> const& values);
  void resolve(std::string const& key, std::string const& word);

  /// As word(), for the key that says which others the table has: where it is wrong, they are excused.
  std::string kind_word(std::string const& key, std::string const& fallback, std::vector<std::string> const& words);
  /// Takes every key of the table as read: what they mean hangs on one that was refused.
  void excuse();

  /// Takes the key, or the whole table of that name, as read: it is somebody else's business.
  void pass_over(std::string const& key);

  /// Refuses the key if it is there: `reason` says why, e.g. "is not available yet: thin lenses only".
  void refuse(std::string const& key, std::string const& reason);

  /// Adds a problem at this key (or at the table where the key is absent).
  void problem(std::string const& key, std::string const& message);
  /// "file:line:column" of the key, of the table where it is absent, or "--set ...".
  std::string where(std::string const& key) const;

 private:
  SetupDocument::State* state_;
  std::vector<std::string> path_;
};

}  // namespace gladstone
