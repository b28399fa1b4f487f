#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "render/files/text_file.h"

namespace gladstone::inline files {

/// Fields of the header of a NRRD file by name ("sizes: 24 20 16"), with errors that name the field. A field may be
/// repeated with the same value only.
class NrrdFields {
 public:
  /// @param path  the file, for errors
  explicit NrrdFields(std::string path) : path_(std::move(path)) {}

  /// Reads up to the empty line that ends an attached header, or to the end of a detached one.
  /// @return true if there was an empty line
  /// @throws DataError for a line that is not a field, and for a field with two values
  bool read(LineReader& file);

  /// Returns the names of the data files after "data file: LIST".
  std::vector<std::string> const& listed_files() const { return listed_files_; }
  static bool is_list(std::string const& value) { return value == "LIST" || value.starts_with("LIST "); }

  /// Throws a DataError that quotes the field.
  [[noreturn]] void refuse(ErrorCode code, std::string const& key, std::string const& why) const;

  bool has(std::string const& key) const { return values_.count(key) > 0; }
  /// Returns the text of a field. @throws DataError if it is missing
  std::string const& required(std::string const& key) const;
  /// Returns the text of a field; empty if it is missing.
  std::string text(std::string const& key) const { return has(key) ? values_.at(key) : std::string(); }

  /// Returns a whole number of at least `low`; `fallback` if the field is missing.
  template <class Number>
  Number number(std::string const& key, Number fallback, Number low) const;

  /// Returns the numbers of a field. @throws DataError if there are not `count` of them
  template <class Number>
  std::vector<Number> numbers(std::string const& key, std::size_t count) const;

  /// Parses vectors, "(1,0,0) none (0,1,0)"; "none" gives an empty vector.
  std::vector<std::vector<double>> vectors(std::string const& key) const;

  /// Parses the quoted words of a field, one per axis: "mm" "mm" "???"; "???" gives an empty text.
  std::vector<std::string> quoted_words(std::string const& key) const;

 private:
  /// Parses a number; nullopt if the word is none.
  template <class Number>
  static std::optional<Number> parsed(std::string const& word);
  void store(LineReader const& file, std::string const& key, std::string const& value);
  void read_list(LineReader& file);

  std::string path_;
  std::map<std::string, std::string> values_;
  std::map<std::string, std::size_t> lines_;  ///< number of the line of each field
  std::vector<std::string> listed_files_;
};

}  // namespace gladstone::inline files
