#pragma once

#include <string>
#include <vector>

namespace gladstone {

/// Where output is to go, as an absolute path through all links, and the folders above it that had to be made.
class OutputPlace {
 public:
  /// Makes nothing. @throws OutputError where nothing can stand there: a name of a process's open file (/dev/stdout,
  /// /proc/self/fd/1), an empty name, a link that leads nowhere
  explicit OutputPlace(std::string path);

  /// As the user gave it, for messages.
  std::string const& asked() const { return asked_; }
  std::string const& path() const { return path_; }
  std::string folder() const;
  std::string name() const;

  /// Makes the missing folders above. @throws OutputError
  void make_parents();
  /// Removes those again, where they are empty.
  void remove_made_parents() const;

  /// @throws OutputError "PATH: WHAT (why); what to do about it" @param error errno
  [[noreturn]] void fail(std::string const& what, int error) const;

 private:
  std::string asked_, path_;
  std::vector<std::string> made_;
};

/// What stands at a path that is neither a file nor a folder: "a device"; empty for those and for nothing.
std::string special_file(std::string const& path);

/// Makes sure that no output is an input: the same file or folder, under whatever name, through links or as another
/// hard link. @throws OutputError naming both
void refuse_inputs_as_outputs(std::vector<std::string> const& outputs, std::vector<std::string> const& inputs);

}  // namespace gladstone
