#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace gladstone {

/// One thing wrong with a setup: where it stands and what to do about it.
struct SetupProblem {
  std::string where;    ///< "file:line:column", or "--set key=value"
  std::string message;  ///< "key = value: problem (why); suggestion"
};

/// Everything wrong with a user's setup, reported together. Exit code 2.
class SetupError : public std::runtime_error {
 public:
  explicit SetupError(std::vector<SetupProblem> problems);
  std::vector<SetupProblem> const& problems() const { return problems_; }

 private:
  std::vector<SetupProblem> problems_;
};

/// A data file that is missing, broken or not what it should be; names the file and the dataset. Exit code 2.
class DataError : public std::runtime_error {
 public:
  DataError(std::string const& file, std::string const& message) : std::runtime_error(file + ": " + message) {}
};

/// An output that cannot be written (read-only folder, full disk). Exit code 2.
class OutputError : public std::runtime_error {
 public:
  OutputError(std::string const& path, std::string const& message)
      : std::runtime_error(path + ": " + message), path_(path), message_(message) {}
  std::string const& path() const { return path_; }
  std::string const& message() const { return message_; }

 private:
  std::string path_, message_;
};

/// An accelerator that is absent, out of memory or failing. Exit code 5.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user pressed Ctrl-C. Exit code 130.
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(std::string const& message = "interrupted; nothing was left behind")
      : std::runtime_error(message) {}
};

}  // namespace gladstone
