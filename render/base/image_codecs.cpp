#include "render/base/image_codecs.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>

#include "render/base/error.h"

namespace gladstone {
namespace {

constexpr char const* library_name = "libgladstone_image_codecs.so";

ImageCodecs const& load_image_codecs() {
  char const* const folder = std::getenv("GLADSTONE_IMAGE_CODECS");
  std::string const path =
      folder != nullptr && *folder != '\0' ? std::string(folder) + '/' + library_name : library_name;
  void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  char const* const why = library == nullptr ? dlerror() : nullptr;
  auto const entry =
      library != nullptr ? reinterpret_cast<ImageCodecsEntry>(dlsym(library, "gladstone_image_codecs")) : nullptr;
  if (entry == nullptr) {
    throw DataError(path, fmt::format("cannot be loaded, and no picture be read or written without it ({}); it belongs "
                                      "beside the libraries of gladstone (bin/../lib of an installation): install "
                                      "gladstone anew, or set GLADSTONE_IMAGE_CODECS to its folder",
                                      why != nullptr ? why : "it is another library"));
  }
  return *entry();
}

}  // namespace

ImageCodecs const& image_codecs() {
  static ImageCodecs const& codecs = load_image_codecs();
  return codecs;
}

}  // namespace gladstone
