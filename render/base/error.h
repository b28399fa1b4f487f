#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace gladstone {

/// Kinds of problems in a setup, for programs that handle problems by kind.
enum class ProblemCode {
  invalid_value,    ///< a value that does not fit the others, or any other problem
  unknown_key,      ///< a key or table that is not read
  missing_key,      ///< a required key without a value
  wrong_type,       ///< a text instead of a number, or an array of another length
  out_of_range,     ///< a number outside its limits
  unknown_choice,   ///< a word that is not one of the choices
  syntax,           ///< a file or an assignment that is not TOML
  unreadable_file,  ///< a setup file that is missing or cannot be read
  memory,           ///< a value for which the available memory does not suffice
};

/// Returns the name of a code: "out_of_range".
std::string problem_code_name(ProblemCode code);

/// One problem in a setup: its location and how to correct it.
struct SetupProblem {
  std::string where;     ///< "file:line:column", or "--set key=value"
  std::string message;   ///< "key = value: problem (why); suggestion"
  std::string key = {};  ///< path of the key or table, "lens.f_number"; empty: not a problem of one key
  ProblemCode code = ProblemCode::invalid_value;
};

/// Base class of errors whose text was written for the user; see format_user_message().
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
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

/// A data file that is missing, damaged or of unexpected content; the message contains the file and the dataset. Exit
/// code 2.
class DataError : public Error {
 public:
  DataError(std::string const& file, std::string const& message)
      : Error(file + ": " + message), file_(file), message_(message) {}
  /// file, or key of a setup, that contains the problem
  std::string const& file() const { return file_; }
  std::string const& message() const { return message_; }

 private:
  std::string file_, message_;
};

/// A vector field without a single valid vector. Exit code 1.
class NoValidVector : public DataError {
 public:
  using DataError::DataError;
};

/// A file or a key of a setup that needs more memory than is available, now or on this machine. Exit code 2.
class MemoryError : public DataError {
 public:
  using DataError::DataError;
};

/// An output that cannot be written (read-only directory, full disk). Exit code 2.
class OutputError : public Error {
 public:
  OutputError(std::string const& path, std::string const& message)
      : Error(path + ": " + message), path_(path), message_(message) {}
  std::string const& path() const { return path_; }
  std::string const& message() const { return message_; }

 private:
  std::string path_, message_;
};

/// An accelerator that is absent, out of memory or failing. Exit code 5.
class DeviceError : public Error {
 public:
  using Error::Error;
};

/// Work that needs more memory of the accelerator than is free. Exit code 5.
class DeviceMemoryError : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// The user pressed Ctrl-C. Exit code 130.
class Interrupted : public Error {
 public:
  explicit Interrupted(std::string const& message = "interrupted; nothing was left behind") : Error(message) {}
};

/// Returns true if an error means that memory is exhausted: std::bad_alloc, std::length_error (a size refused before
/// its allocation), MemoryError, DeviceMemoryError, a SetupError with a problem of code `memory`, or an OpenCV error of
/// code -4.
bool is_out_of_memory(std::exception const& error);

/// Returns the text that is shown to the user for an error. The text of an Error is returned as it is; errors of
/// libraries are put into a sentence that says what failed and what to do.
std::string format_user_message(std::exception const& error);

}  // namespace gladstone
