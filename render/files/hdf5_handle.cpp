#include "render/files/hdf5_handle.h"

#include <hdf5.h>

#include <map>

namespace gladstone::inline files::hdf5 {
namespace {

/// Element of the attribute REFERENCE_LIST of a scale: a dataset and the axis to which the scale is attached.
struct ScaleUse {
  hobj_ref_t dataset;
  int axis;
  int padding = 0;  ///< keeps equal files equal byte by byte
};

bool write_list(hid_t object, char const* name, hid_t type, std::size_t count, void const* values) {
  hsize_t const size = count;
  Id const space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  Id const attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute.valid() && H5Awrite(attribute, type, values) >= 0;
}

/// Writes a text of fixed length, which is how the specification stores CLASS and NAME.
bool write_fixed_text(hid_t object, char const* name, std::string const& text) {
  Id const type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, text.size() + 1);
  Id const space(H5Screate(H5S_SCALAR), H5Sclose);
  Id const attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute.valid() && H5Awrite(attribute, type, text.c_str()) >= 0;
}

/// Writes the list of a dataset's scales, one for each axis.
bool write_dimension_list(hid_t dataset, std::vector<hobj_ref_t>& scales) {
  std::vector<hvl_t> lists;
  for (hobj_ref_t& scale : scales) lists.push_back({1, &scale});
  Id const type(H5Tvlen_create(H5T_STD_REF_OBJ), H5Tclose);
  return write_list(dataset, "DIMENSION_LIST", type, lists.size(), lists.data());
}

bool write_scale(hid_t file, std::string const& path, std::vector<ScaleUse> const& uses) {
  Id const scale(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
  Id const type(H5Tcreate(H5T_COMPOUND, sizeof(ScaleUse)), H5Tclose);
  H5Tinsert(type, "dataset", HOFFSET(ScaleUse, dataset), H5T_STD_REF_OBJ);
  H5Tinsert(type, "dimension", HOFFSET(ScaleUse, axis), H5T_NATIVE_INT);
  return scale.valid() && write_fixed_text(scale, "CLASS", "DIMENSION_SCALE") &&
         write_fixed_text(scale, "NAME", steps(path).back()) &&
         write_list(scale, "REFERENCE_LIST", type, uses.size(), uses.data());
}

}  // namespace

bool attach_scales(std::int64_t file, std::vector<ScaledDataset> const& datasets) {
  std::map<std::string, std::vector<ScaleUse>> uses;
  for (ScaledDataset const& one : datasets) {
    ScaleUse use{};
    Id const opened(H5Dopen2(file, one.dataset.c_str(), H5P_DEFAULT), H5Dclose);
    if (!opened.valid() || H5Rcreate(&use.dataset, file, one.dataset.c_str(), H5R_OBJECT, -1) < 0) return false;
    std::vector<hobj_ref_t> scales(one.scales.size());
    for (std::size_t axis = 0; axis < scales.size(); ++axis) {
      if (H5Rcreate(&scales[axis], file, one.scales[axis].c_str(), H5R_OBJECT, -1) < 0) return false;
      use.axis = static_cast<int>(axis);
      uses[one.scales[axis]].push_back(use);
    }
    if (!write_dimension_list(opened, scales)) return false;
  }
  for (auto const& [scale, list] : uses) {
    if (!write_scale(file, scale, list)) return false;
  }
  return true;
}

}  // namespace gladstone::inline files::hdf5
