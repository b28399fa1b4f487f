#include "render/base/fields/field_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include "render/base/error.h"
#include "render/base/fields/readers/jhtdb.h"
#include "render/base/fields/readers/nrrd.h"
#include "render/base/fields/readers/vti.h"
#include "render/base/input_file.h"

namespace gladstone {
namespace {

struct FieldFormat {
  char const* extension;
  std::unique_ptr<FieldSource> (*open)(std::string const& path, std::string const& dataset, int values);
};

/// One row per format: its reader and how its files are called.
constexpr std::array field_formats{
    FieldFormat{".h5", open_jhtdb},  FieldFormat{".hdf5", open_jhtdb}, FieldFormat{".vti", open_vti},
    FieldFormat{".nrrd", open_nrrd}, FieldFormat{".nhdr", open_nrrd},
};

}  // namespace

std::unique_ptr<FieldSource> open_field(std::string const& path, std::string const& dataset, int values) {
  require_input_file(path, "a field file");
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::string known;
  for (auto const& format : field_formats) {
    if (extension == format.extension) return format.open(path, dataset, values);
    known += (known.empty() ? "" : ", ") + std::string(format.extension);
  }
  throw DataError(path, "is of no format that is read here; known are " + known);
}

}  // namespace gladstone
