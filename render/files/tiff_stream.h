#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>

struct tiff;  // TIFF of <tiffio.h>

/// Helpers shared by the files that call libtiff, tiff_reader.cpp and tiff_writer.cpp; not for other files.
namespace gladstone::inline files {

struct TiffCloser {
  void operator()(tiff* handle) const;
};
using TiffHandle = std::unique_ptr<tiff, TiffCloser>;

/// Storage that libtiff reads from or writes to, with the first error on it. libtiff is written in C: the stream stores
/// exceptions of its storage, and check_error() throws them again.
class TiffStream {
 public:
  TiffStream() = default;
  virtual ~TiffStream() = default;
  TiffStream(TiffStream const&) = delete;
  TiffStream& operator=(TiffStream const&) = delete;

  /// Opens a TIFF in this storage; warnings and error messages of libtiff are not printed.
  /// @param name  name of the file, for error messages
  /// @param mode  mode of TIFFOpen()
  /// @return handle that must be closed before this stream is destroyed; nullptr on failure
  TiffHandle open(std::string const& name, char const* mode);

  /// Returns the first error message of libtiff since the last call; empty if there was none.
  /// @throws the exception that the storage threw since the last call
  std::string check_error();

 private:
  /// Functions that libtiff calls.
  struct Callbacks;

  /// Reads up to `size` bytes; fewer only at the end. @return number of bytes read
  virtual std::size_t read(std::uint64_t offset, void* to, std::size_t size) = 0;
  virtual void write(std::uint64_t offset, void const* from, std::size_t size) = 0;
  virtual std::uint64_t size() const = 0;

  std::uint64_t position_ = 0;
  std::string error_;
  std::exception_ptr exception_;
};

}  // namespace gladstone::inline files
