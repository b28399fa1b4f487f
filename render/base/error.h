#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace gladstone::inline base {

/// Kind of an error. `code` in the JSON of --json and of the Python exceptions is its name; docs/reference/errors.md
/// lists them.
enum class ErrorCode {
  // Errors in a setup or another text with keys
  invalid_value,   ///< a value that is not finite, or contradicts another value of the same input
  unknown_key,     ///< a key or table that is not read
  missing_key,     ///< a required key without a value
  wrong_type,      ///< a text instead of a number, or an array of another length
  out_of_range,    ///< a number outside its limits
  unknown_choice,  ///< a word that is not one of the choices
  syntax,          ///< a text that cannot be parsed: not TOML, or a table with a line that is not one of its rows
  // Errors in an input file
  missing_file,     ///< a file or folder that does not exist
  unreadable_file,  ///< a file or folder that cannot be opened or read, such as one without permission
  wrong_format,     ///< an input of another format or kind than required, such as a text in place of an image
  damaged,          ///< a file that is cut short, damaged or contradicts itself
  unsupported,      ///< a valid input that gladstone does not support, such as a compression method or a curved grid
  missing_content,  ///< a file without a required dataset, column, page, row or attribute
  wrong_shape,      ///< an image or array of another size than required
  inconsistent,     ///< an input that contradicts another one, such as vectors of other frames
  changed,          ///< a file that has changed since its content was used
  // Errors in a computation
  undetermined,     ///< inputs that are too few, too similar or ambiguous to determine the result
  no_valid_vector,  ///< a vector field without a single valid vector
  memory,           ///< a computation that needs more memory than is available
  // Errors of outputs, accelerators and arguments, and of the program itself
  output,            ///< an output that cannot be written or would overwrite other data
  overwrites_input,  ///< an output that would overwrite an input of the same command
  device,            ///< an accelerator that is absent, out of memory or failing
  arguments,         ///< a command line or call whose arguments are incomplete or contradictory
  interrupted,       ///< a run that the user stopped by Ctrl-C
  internal,          ///< an unexpected error of gladstone or of a library
};

/// Returns the name of a code: "out_of_range".
std::string error_code_name(ErrorCode code);

/// One problem in a setup: its location and how to correct it.
struct SetupProblem {
  std::string where;     ///< "file:line:column", or "--set key=value"
  std::string message;   ///< "key = value: problem (why); suggestion"
  std::string key = {};  ///< path of the key or table, "lens.f_number"; empty: not a problem of one key
  ErrorCode code = ErrorCode::invalid_value;
};

/// Key path of a setup, "lens.f_number", as the place of an error.
struct KeyPath {
  std::string path;
};

/// Base class of errors whose text was written for the user; see format_user_message(). An error is a record of place,
/// code and message, "PLACE: MESSAGE" in what(); programs inspect the code and the place, never the message.
class Error : public std::runtime_error {
 public:
  /// An error without a place.
  Error(ErrorCode code, std::string const& message) : runtime_error(message), code_(code), message_(message) {}
  Error(ErrorCode code, std::string const& place, std::string const& message)
      : runtime_error(place + ": " + message), code_(code), place_(place), message_(message) {}
  Error(ErrorCode code, KeyPath const& key, std::string const& message) : Error(code, key.path, message) {
    at_key_ = true;
  }
  ErrorCode code() const { return code_; }
  /// Returns the place of the error: "file", "file:line", "file:line:column", key path of a setup, or name of another
  /// input; may be empty.
  std::string const& place() const { return place_; }
  /// Returns the path of the setup's key that causes the error; empty if the place is not a key.
  std::string key() const { return at_key_ ? place_ : ""; }
  std::string const& message() const { return message_; }

 private:
  ErrorCode code_;
  std::string place_, message_;
  bool at_key_ = false;
};

/// Maximum number of problems that a SetupError describes; further ones are only counted.
inline constexpr std::size_t max_reported_problems = 20;

/// All problems of a user's setup. The message has one line for each of the first max_reported_problems problems, then
/// the number of further ones. Exit code 2.
class SetupError : public Error {
 public:
  /// @param more  number of further problems, without a description
  explicit SetupError(std::vector<SetupProblem> problems, std::size_t more = 0);
  std::vector<SetupProblem> const& problems() const { return problems_; }
  std::size_t more() const { return more_; }

 private:
  std::vector<SetupProblem> problems_;
  std::size_t more_;
};

/// An input that is missing, damaged or of unexpected content, or one that needs too much memory. Exit code 2, or 1 for
/// ErrorCode::no_valid_vector.
class DataError : public Error {
 public:
  /// @param file  file with the problem, "file:line", or name of another input
  DataError(ErrorCode code, std::string const& file, std::string const& message) : Error(code, file, message) {}
  DataError(ErrorCode code, KeyPath const& key, std::string const& message) : Error(code, key, message) {}
};

/// An output that cannot be written (read-only directory, full disk) or would overwrite other data. Exit code 2.
class OutputError : public Error {
 public:
  OutputError(std::string const& path, std::string const& message) : OutputError(ErrorCode::output, path, message) {}
  OutputError(ErrorCode code, std::string const& path, std::string const& message) : Error(code, path, message) {}
};

/// An accelerator that is absent, out of memory or failing. Exit code 5.
class DeviceError : public Error {
 public:
  explicit DeviceError(std::string const& message) : Error(ErrorCode::device, message) {}
};

/// Work that needs more memory of the accelerator than is free. Exit code 5.
class DeviceMemoryError : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// The user pressed Ctrl-C. Exit code 130.
class Interrupted : public Error {
 public:
  explicit Interrupted(std::string const& message = "interrupted; no incomplete files remain")
      : Error(ErrorCode::interrupted, message) {}
};

/// Returns true if an error means that memory is exhausted: std::bad_alloc, std::length_error (a size refused before
/// its allocation), an Error of code `memory`, DeviceMemoryError, or a SetupError with a problem of code `memory`.
bool is_out_of_memory(std::exception const& error);

/// Returns the text that is shown to the user for an error. The text of an Error is returned as it is; errors of
/// libraries are put into a sentence that says what failed and what to do.
std::string format_user_message(std::exception const& error);

}  // namespace gladstone::inline base
