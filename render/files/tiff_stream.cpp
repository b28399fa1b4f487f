#include "render/files/tiff_stream.h"

#include <tiffio.h>

#include <array>
#include <cstdarg>
#include <cstdio>
#include <new>
#include <utility>

namespace gladstone::inline files {

void TiffCloser::operator()(tiff* handle) const { TIFFClose(handle); }

struct TiffStream::Callbacks {
  static TiffStream& stream(thandle_t handle) { return *static_cast<TiffStream*>(handle); }

  static tmsize_t read(thandle_t handle, void* to, tmsize_t size) {
    return transfer(handle, size, [&](TiffStream& stream) {
      return stream.read(stream.position_, to, static_cast<std::size_t>(size));
    });
  }

  static tmsize_t write(thandle_t handle, void* from, tmsize_t size) {
    return transfer(handle, size, [&](TiffStream& stream) {
      stream.write(stream.position_, from, static_cast<std::size_t>(size));
      return static_cast<std::size_t>(size);
    });
  }

  /// Calls `copy`, which returns the number of bytes copied, and moves the position by this number.
  template <class Copy>
  static tmsize_t transfer(thandle_t handle, tmsize_t size, Copy const& copy) {
    TiffStream& self = stream(handle);
    if (size <= 0 || self.exception_) return 0;
    try {
      std::size_t const copied = copy(self);
      self.position_ += copied;
      return static_cast<tmsize_t>(copied);
    } catch (...) {
      self.exception_ = std::current_exception();
      return 0;
    }
  }

  static toff_t seek(thandle_t handle, toff_t offset, int origin) {
    TiffStream& self = stream(handle);
    if (origin == SEEK_CUR) offset += self.position_;
    if (origin == SEEK_END) offset += self.size();
    self.position_ = offset;
    return offset;
  }

  static int close(thandle_t) { return 0; }
  static toff_t size(thandle_t handle) { return stream(handle).size(); }
  /// Reports that the storage is not mapped into memory, where a file that becomes shorter would end the program.
  static int map(thandle_t, void**, toff_t*) { return 0; }
  static void unmap(thandle_t, void*, toff_t) {}

  static int ignore_warning(TIFF*, void*, char const*, char const*, va_list) { return 1; }

  /// Stores the first error message. @return 1: libtiff shall not print it
  static int store_error(TIFF*, void* handle, char const*, char const* format, va_list arguments) {
    TiffStream& self = stream(handle);
    if (!self.error_.empty()) return 1;
    std::array<char, 512> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    try {
      self.error_ = text.data();
    } catch (...) {
      self.exception_ = std::current_exception();
    }
    return 1;
  }
};

TiffHandle TiffStream::open(std::string const& name, char const* mode) {
  std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> const options(TIFFOpenOptionsAlloc(),
                                                                                 &TIFFOpenOptionsFree);
  if (!options) throw std::bad_alloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), &Callbacks::store_error, this);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), &Callbacks::ignore_warning, this);
  return TiffHandle(TIFFClientOpenExt(name.c_str(), mode, this, &Callbacks::read, &Callbacks::write, &Callbacks::seek,
                                      &Callbacks::close, &Callbacks::size, &Callbacks::map, &Callbacks::unmap,
                                      options.get()));
}

std::string TiffStream::check_error() {
  std::string const error = std::exchange(error_, {});
  if (exception_) std::rethrow_exception(std::exchange(exception_, nullptr));
  return error;
}

}  // namespace gladstone::inline files
