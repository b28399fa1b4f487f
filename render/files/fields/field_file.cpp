#include "render/files/fields/field_file.h"

#include <array>
#include <filesystem>

#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/fields/oriented_field.h"
#include "render/files/fields/readers/hdf5.h"
#include "render/files/fields/readers/matlab.h"
#include "render/files/fields/readers/nrrd.h"
#include "render/files/fields/readers/numpy.h"
#include "render/files/fields/readers/point_table.h"
#include "render/files/fields/readers/vtk.h"
#include "render/files/fields/resampled_field.h"
#include "render/files/input_file.h"

namespace gladstone::inline files {
namespace {

struct FieldFormat {
  char const* extension;
  std::unique_ptr<CheckedSource> (*open)(std::string const& path, FieldSelection const& selection);
};

/// Table of formats: file name extension and reader.
constexpr std::array field_formats{
    FieldFormat{".h5", open_hdf5},         FieldFormat{".hdf5", open_hdf5},       FieldFormat{".he5", open_hdf5},
    FieldFormat{".nc", open_hdf5},         FieldFormat{".mat", open_matlab},      FieldFormat{".vti", open_vtk_xml},
    FieldFormat{".vtr", open_vtk_xml},     FieldFormat{".vtk", open_vtk_legacy},  FieldFormat{".nrrd", open_nrrd},
    FieldFormat{".nhdr", open_nrrd},       FieldFormat{".npy", open_npy},         FieldFormat{".npz", open_npz},
    FieldFormat{".csv", open_point_table}, FieldFormat{".txt", open_point_table}, FieldFormat{".dat", open_point_table},
};

}  // namespace

std::vector<std::string> field_extensions() {
  std::vector<std::string> names;
  for (FieldFormat const& format : field_formats) names.emplace_back(format.extension);
  return names;
}

std::unique_ptr<FieldSource> open_field(std::string const& path, std::string const& dataset, int values,
                                        std::string const& axes) {
  require_input_file(path, "a field file");
  std::string const extension = lower_case(std::filesystem::path(path).extension().string());
  for (auto const& format : field_formats) {
    if (extension == format.extension) {
      auto oriented = std::make_unique<OrientedField>(format.open(path, {dataset, values, axes}));
      if (oriented->uniform()) return oriented;
      return std::make_unique<ResampledField>(std::move(oriented));
    }
  }
  std::string known;
  for (std::string const& name : field_extensions()) known += (known.empty() ? "" : ", ") + name;
  throw DataError(ErrorCode::unsupported, path, "has an unsupported format; supported are " + known);
}

}  // namespace gladstone::inline files
