#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace gladstone::inline files {

/// Regular file open for reading; all files named by the user are opened by this class. Directories, pipes, devices and
/// sockets are refused before they are opened, so that no read blocks or never ends.
class InputFile {
 public:
  /// @param wanted  kind of file expected, for the message: "a setup file"
  /// @throws DataError if the file does not exist, may not be read or is not a regular file
  explicit InputFile(std::string const& path, std::string const& wanted = "a file");
  ~InputFile();
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) noexcept;

  std::string const& path() const { return path_; }
  /// Size of the file when it was opened [bytes].
  std::uint64_t size() const { return size_; }
  /// File descriptor, for libraries that read from one; this object remains its owner.
  int descriptor() const { return descriptor_; }

  /// Reads up to `size` bytes from `offset`; fewer only at the end of the file.
  /// @return number of bytes read
  /// @throws DataError if reading fails, Interrupted
  std::size_t read(std::uint64_t offset, void* to, std::size_t size) const;

 private:
  std::string path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// Throws DataError if InputFile cannot open the file; to be called before a library opens a file by name.
inline void require_input_file(std::string const& path, std::string const& wanted) { InputFile(path, wanted); }

}  // namespace gladstone::inline files
