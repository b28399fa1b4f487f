#pragma once

#include <string>
#include <vector>

namespace gladstone::inline files {

/// Destination of an output: its absolute path with all links resolved, and the parent directories created for it.
class OutputDestination {
 public:
  /// Resolves the path; creates nothing.
  /// @throws OutputError if the path is empty, names an open file of a process (/dev/stdout, /proc/self/fd/1), or its
  ///         links form a circle
  explicit OutputDestination(std::string path);

  /// Path as the user wrote it, for messages.
  std::string const& asked() const { return asked_; }
  std::string const& path() const { return path_; }
  std::string folder() const;
  std::string name() const;

  /// Creates the missing parent directories. @throws OutputError
  void make_parents();
  /// Removes the parent directories created by make_parents() that are empty.
  void remove_made_parents() const;

  /// Throws OutputError "PATH: WHAT (reason); remedy".
  /// @param error  errno, from which the reason and the remedy are derived
  [[noreturn]] void fail(std::string const& what, int error) const;

 private:
  std::string asked_, path_;
  std::vector<std::string> made_;
};

/// Returns "a pipe", "a socket" or "a device" for the path of one; empty for files, directories and missing paths.
std::string special_file(std::string const& path);

/// @throws OutputError of code overwrites_input that names both
[[noreturn]] void refuse_overwriting(std::string const& input, std::string const& output);

/// Checks that no output is the same file or directory as an input, under any name: also through links or as another
/// hard link.
/// @throws the exceptions of refuse_overwriting()
void refuse_inputs_as_outputs(std::vector<std::string> const& outputs, std::vector<std::string> const& inputs);

}  // namespace gladstone::inline files
