#include "render/files/image_codecs.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <pthread.h>
#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <thread>

#include "render/base/error.h"

namespace gladstone::inline files {
namespace {

constexpr char const* library_name = "libgladstone_image_codecs.so";

/// Address space required to load the library and its 250 dependencies on Debian 12 [bytes]. 330 MB are mapped; all of
/// them start from 365 MB on.
constexpr std::size_t library_space = std::size_t{400} << 20;

/// Returns the address space for the threads that these libraries start, one per core [bytes].
std::size_t thread_space() {
  pthread_attr_t attributes;
  std::size_t stack = std::size_t{8} << 20;
  if (::pthread_attr_init(&attributes) == 0) {
    ::pthread_attr_getstacksize(&attributes, &stack);
    ::pthread_attr_destroy(&attributes);
  }
  return std::thread::hardware_concurrency() * (stack + (std::size_t{1} << 20));
}

/// Throws an error of code `memory` if the limit on address space (ulimit -v) is too low: libraries that reach it
/// during their initialisation abort or hang.
void require_address_space(std::string const& path) {
  std::size_t const needed = library_space + thread_space();
  void* const probe = ::mmap(nullptr, needed, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (probe != MAP_FAILED) {
    ::munmap(probe, needed);
    return;
  }
  throw DataError(
      ErrorCode::memory, path,
      fmt::format("cannot be loaded, and without it only intact TIFF images can be read (not enough memory: it needs "
                  "{} MB of address space); raise the limit (ulimit -v), or use a machine with more memory",
                  needed >> 20));
}

ImageCodecs const& load_image_codecs() {
  char const* const folder = std::getenv("GLADSTONE_IMAGE_CODECS");
  std::string const path =
      folder != nullptr && *folder != '\0' ? std::string(folder) + '/' + library_name : library_name;
  require_address_space(path);
  void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  char const* const why = library == nullptr ? dlerror() : nullptr;
  auto const entry =
      library != nullptr ? reinterpret_cast<ImageCodecsEntry>(dlsym(library, image_codecs_entry)) : nullptr;
  if (entry == nullptr) {
    throw DataError(
        ErrorCode::unreadable_file, path,
        fmt::format("cannot be loaded, and without it only intact TIFF images can be read ({}); wheels of "
                    "the Python package do not contain it: convert the image to TIFF, read it with another "
                    "library and pass the array, or install gladstone's Debian package of the same version. "
                    "In other installations it belongs in bin/../lib: install gladstone again, or set "
                    "GLADSTONE_IMAGE_CODECS to its folder",
                    why != nullptr ? why : "it is another library"));
  }
  return *entry();
}

}  // namespace

ImageCodecs const& loaded_image_codecs() {
  static ImageCodecs const& codecs = load_image_codecs();
  return codecs;
}

}  // namespace gladstone::inline files
