#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace gladstone {

/// One thing wrong with a setup: where it stands and what to do about it.
struct SetupProblem {
  std::string where;    ///< "file:line:column", or "--set key=value"
  std::string message;  ///< "key = value: problem (why); suggestion"
};

/// What is told in our own words, for the user to read; see message_of().
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Most problems of a setup that are told; the others are counted.
inline constexpr std::size_t most_problems_told = 20;

/// Everything wrong with a user's setup, reported together: the first most_problems_told, a line each, and how many
/// more there are. Exit code 2.
class SetupError : public Error {
 public:
  /// @param more problems beside these that nobody put into words
  explicit SetupError(std::vector<SetupProblem> problems, std::size_t more = 0);
  std::vector<SetupProblem> const& problems() const { return problems_; }
  std::size_t more() const { return more_; }

 private:
  std::vector<SetupProblem> problems_;
  std::size_t more_;
};

/// A data file that is missing, broken or not what it should be; names the file and the dataset. Exit code 2.
class DataError : public Error {
 public:
  DataError(std::string const& file, std::string const& message)
      : Error(file + ": " + message), file_(file), message_(message) {}
  /// The file, or the key of a setup, that is at fault, and what is wrong with it.
  std::string const& file() const { return file_; }
  std::string const& message() const { return message_; }

 private:
  std::string file_, message_;
};

/// Vectors none of which is valid. Exit code 1.
class NoValidVector : public DataError {
 public:
  using DataError::DataError;
};

/// A file that takes more memory than there is: another moment or machine has more. Exit code 2.
class MemoryError : public DataError {
 public:
  using DataError::DataError;
};

/// An output that cannot be written (read-only folder, full disk). Exit code 2.
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

/// The user pressed Ctrl-C. Exit code 130.
class Interrupted : public Error {
 public:
  explicit Interrupted(std::string const& message = "interrupted; nothing was left behind") : Error(message) {}
};

/// Whether an error is the lack of memory: the standard library's, also where it refuses a size before it asks, a
/// MemoryError, or OpenCV's.
bool lacks_memory(std::exception const& error);

/// What the user is told of an error: our own words. Of a library's error they stand around its text, which alone says
/// neither what failed nor what to do.
std::string message_of(std::exception const& error);

}  // namespace gladstone
