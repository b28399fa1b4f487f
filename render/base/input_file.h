#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace gladstone {

/// A regular file open for reading: the one way in which files of the user are opened. A folder, a pipe, a device or a
/// socket is refused by name before it is opened, so that nothing waits for a writer or reads without end.
class InputFile {
 public:
  /// @param wanted what to name instead, "a setup file"
  /// @throws DataError where it is missing, may not be read or is no regular file
  explicit InputFile(std::string const& path, std::string const& wanted = "a file");
  ~InputFile();
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) noexcept;

  std::string const& path() const { return path_; }
  /// Bytes when it was opened.
  std::uint64_t size() const { return size_; }
  /// For libraries that read by descriptor; it stays this object's.
  int descriptor() const { return descriptor_; }

  /// Reads up to `size` bytes from `offset` on; fewer only where the file ends. @throws DataError, Interrupted
  std::size_t read(std::uint64_t offset, void* to, std::size_t size) const;

 private:
  std::string path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// Refuses what InputFile refuses: for libraries that open files by name.
inline void require_input_file(std::string const& path, std::string const& wanted) { InputFile(path, wanted); }

}  // namespace gladstone
