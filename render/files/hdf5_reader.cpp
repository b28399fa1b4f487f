#include <hdf5.h>

#include <algorithm>
#include <array>
#include <set>

#include "render/base/available_memory.h"
#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/files/hdf5_reader_handle.h"
#include "render/files/input_file.h"

namespace gladstone::inline files {
using namespace hdf5;
namespace {

/// H5Lvisit callback that collects the names of all links below a group: hard links in list 0, soft and external ones
/// in list 1. Linked groups are not entered.
herr_t collect_link(hid_t, char const* name, H5L_info_t const* info, void* names) {
  bool const direct = info->type == H5L_TYPE_HARD;
  auto& lists = *static_cast<std::array<std::vector<std::string>, 2>*>(names);
  lists[direct ? 0 : 1].emplace_back(name);
  return 0;
}

template <class Value>
std::vector<Value> read_whole(hid_t dataset, hid_t type, std::string const& path, std::string const& name) {
  auto const shape = shape_of(dataset);
  // A damaged header can declare any size.
  std::string const what = "dataset \"" + name + "\" of " + sizes_text(shape) + " values";
  require_memory(path, what, std::accumulate(shape.begin(), shape.end(), 1.0 * sizeof(Value), std::multiplies<>()));
  std::vector<Value> values(product(shape));
  if (!values.empty() && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    throw_unreadable(dataset, path, name);
  }
  return values;
}

}  // namespace

Hdf5Reader::Hdf5Reader(std::string const& path) : path_(path) {
  Lock const lock(library_lock());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::uint64_t const bytes = InputFile(path, "an HDF5 file").size();
  if (H5Fis_hdf5(path.c_str()) <= 0)
    throw DataError(ErrorCode::wrong_format, path, "is not an HDF5 file; check the name, or make or fetch it again");
  Id const access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
#if H5_VERSION_GE(1, 10, 7)
  H5Pset_file_locking(access, false, true);  // read-only access needs no lock, and some file systems have none
#endif
  Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose);
  if (!file.valid())
    throw DataError(ErrorCode::damaged, path, "cannot be opened as HDF5 (it is damaged or cut short); copy it again");
  handle_ = std::unique_ptr<Handle>(new Handle{.file = std::move(file), .bytes = bytes, .rows_name = {}});
}

Hdf5Reader::~Hdf5Reader() {
  Lock const lock(library_lock());
  handle_.reset();
}
Hdf5Reader::Hdf5Reader(Hdf5Reader&&) noexcept = default;

bool Hdf5Reader::has(std::string const& dataset) const {
  Lock const lock(library_lock());
  std::string below;
  for (auto const& step : steps(dataset)) {
    below += '/' + step;
    if (H5Lexists(handle_->file, below.c_str(), H5P_DEFAULT) <= 0) return false;
  }
  Id const object(H5Oopen(handle_->file, dataset.c_str(), H5P_DEFAULT), H5Oclose);
  return object.valid() && H5Iget_type(object) == H5I_DATASET;
}

std::vector<std::string> Hdf5Reader::dataset_names() const {
  Lock const lock(library_lock());
  auto names = all_datasets(handle_->file);
  std::erase_if(names, [](std::string const& name) { return name.find('/') != std::string::npos; });
  return names;
}

std::vector<std::string> Hdf5Reader::number_datasets() const {
  Lock const lock(library_lock());
  std::vector<std::string> names;
  for (std::string const& name : all_datasets(handle_->file)) {
    Id const opened(H5Dopen2(handle_->file, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!opened.valid())
      throw DataError(ErrorCode::damaged, path_, "dataset \"" + name + "\" cannot be opened (the file is damaged)");
    Id const type(H5Dget_type(opened), H5Tclose);
    H5T_class_t const kind = H5Tget_class(type);
    if (kind == H5T_INTEGER || kind == H5T_FLOAT) names.push_back('/' + name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> Hdf5Reader::linked_number_datasets() const {
  Lock const lock(library_lock());
  std::array<std::vector<std::string>, 2> links;
  H5Lvisit(handle_->file, H5_INDEX_NAME, H5_ITER_INC, collect_link, &links);
  std::vector<std::string> names;
  std::set<std::pair<unsigned long, haddr_t>> seen;
  for (auto const& list : links) {
    for (std::string const& name : list) {
      Id const object(H5Oopen(handle_->file, name.c_str(), H5P_DEFAULT), H5Oclose);
      H5O_info_t info;
      bool const dataset = object.valid() && H5Iget_type(object) == H5I_DATASET && H5Oget_info(object, &info) >= 0;
      if (!dataset || !seen.emplace(info.fileno, info.addr).second) continue;
      Id const type(H5Dget_type(object), H5Tclose);
      H5T_class_t const kind = H5Tget_class(type);
      if (kind == H5T_INTEGER || kind == H5T_FLOAT) names.push_back(name);
    }
  }
  return names;
}

std::vector<std::string> Hdf5Reader::describe_other_datasets() const {
  Lock const lock(library_lock());
  std::vector<std::string> texts;
  for (std::string const& name : all_datasets(handle_->file)) {
    Id const opened(H5Dopen2(handle_->file, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!opened.valid()) continue;
    Id const type(H5Dget_type(opened), H5Tclose);
    H5T_class_t const kind = H5Tget_class(type);
    if (kind != H5T_INTEGER && kind != H5T_FLOAT) texts.push_back('"' + name + "\" of " + type_name(type));
  }
  return texts;
}

std::vector<std::string> Hdf5Reader::dimension_scales(std::string const& dataset) const {
  Lock const lock(library_lock());
  Id const opened = handle_->open(path_, dataset);
  std::vector<std::string> scales(shape_of(opened).size());
  constexpr char const* name = "DIMENSION_LIST";
  if (H5Aexists(opened, name) <= 0) return scales;
  Id const attribute(H5Aopen(opened, name, H5P_DEFAULT), H5Aclose);
  Id const stored(H5Aget_type(attribute), H5Tclose);
  Id const space(H5Aget_space(attribute), H5Sclose);
  bool const fits =
      H5Tget_class(stored) == H5T_VLEN && H5Sget_simple_extent_npoints(space) == static_cast<hssize_t>(scales.size());
  if (!fits) return scales;
  Id const element(H5Tget_super(stored), H5Tclose);
  if (H5Tequal(element, H5T_STD_REF_OBJ) <= 0) return scales;
  Id const type(H5Tvlen_create(H5T_STD_REF_OBJ), H5Tclose);
  std::vector<hvl_t> lists(scales.size());
  if (H5Aread(attribute, type, lists.data()) < 0) return scales;
  for (std::size_t axis = 0; axis < scales.size(); ++axis) {
    if (lists[axis].len == 0) continue;
    Id const scale(H5Rdereference2(opened, H5P_DEFAULT, H5R_OBJECT, lists[axis].p), H5Oclose);
    if (!scale.valid() || H5Iget_type(scale) != H5I_DATASET) continue;
    ssize_t const size = H5Iget_name(scale, nullptr, 0);
    if (size <= 0) continue;
    scales[axis].resize(static_cast<std::size_t>(size) + 1);
    H5Iget_name(scale, scales[axis].data(), scales[axis].size());
    scales[axis].pop_back();
  }
  H5Dvlen_reclaim(type, space, H5P_DEFAULT, lists.data());
  return scales;
}

std::vector<std::string> Hdf5Reader::dimension_labels(std::string const& dataset) const {
  Lock const lock(library_lock());
  Id const opened = handle_->open(path_, dataset);
  std::vector<std::string> labels(shape_of(opened).size());
  constexpr char const* name = "DIMENSION_LABELS";
  if (H5Aexists(opened, name) <= 0) return labels;
  Id const attribute(H5Aopen(opened, name, H5P_DEFAULT), H5Aclose);
  Id const stored(H5Aget_type(attribute), H5Tclose);
  Id const space(H5Aget_space(attribute), H5Sclose);
  bool const fits = H5Tget_class(stored) == H5T_STRING && H5Tis_variable_str(stored) > 0 &&
                    H5Sget_simple_extent_npoints(space) == static_cast<hssize_t>(labels.size());
  if (!fits) return labels;
  std::vector<char*> texts(labels.size(), nullptr);
  if (H5Aread(attribute, stored, static_cast<void*>(texts.data())) < 0) return labels;
  for (std::size_t axis = 0; axis < labels.size(); ++axis) {
    if (texts[axis]) labels[axis] = texts[axis];
  }
  H5Dvlen_reclaim(stored, space, H5P_DEFAULT, static_cast<void*>(texts.data()));
  return labels;
}

std::vector<std::size_t> Hdf5Reader::shape(std::string const& dataset) const {
  Lock const lock(library_lock());
  return shape_of(handle_->open(path_, dataset));
}

int Hdf5Reader::significant_bits(std::string const& dataset) const {
  Lock const lock(library_lock());
  Id const opened = handle_->open(path_, dataset);
  Id const type(H5Dget_type(opened), H5Tclose);
  std::size_t mantissa = H5Tget_precision(type);
  if (H5Tget_class(type) == H5T_FLOAT) {
    std::size_t sign = 0, exponent = 0, exponent_size = 0, at = 0;
    H5Tget_fields(type, &sign, &exponent, &exponent_size, &at, &mantissa);
    ++mantissa;  // the leading 1 of the mantissa is implicit
  }
  return static_cast<int>(mantissa);
}

std::vector<double> Hdf5Reader::read(std::string const& dataset) const {
  Lock const lock(library_lock());
  return read_whole<double>(handle_->open(path_, dataset), H5T_NATIVE_DOUBLE, path_, dataset);
}

std::vector<std::int64_t> Hdf5Reader::read_integers(std::string const& dataset) const {
  Lock const lock(library_lock());
  return read_whole<std::int64_t>(handle_->open(path_, dataset, true), H5T_NATIVE_INT64, path_, dataset);
}

void Hdf5Reader::read_rows(std::string const& dataset, std::size_t first, std::size_t count,
                           std::span<double> out) const {
  Lock const lock(library_lock());
  auto const shape = shape_of(handle_->open_rows(path_, dataset));
  GLADSTONE_EXPECTS(!shape.empty() && first + count <= shape[0]);
  std::vector<hsize_t> start(shape.size(), 0), size(shape.begin(), shape.end());
  start[0] = first;
  size[0] = count;
  handle_->read(path_, dataset, start, size, out);
}

void Hdf5Reader::read_box(std::string const& dataset, std::vector<std::size_t> const& start,
                          std::vector<std::size_t> const& size, std::span<double> out) const {
  Lock const lock(library_lock());
  auto const shape = shape_of(handle_->open_rows(path_, dataset));
  GLADSTONE_EXPECTS(start.size() == shape.size() && size.size() == shape.size());
  for (std::size_t axis = 0; axis < shape.size(); ++axis) GLADSTONE_EXPECTS(start[axis] + size[axis] <= shape[axis]);
  handle_->read(path_, dataset, {start.begin(), start.end()}, {size.begin(), size.end()}, out);
}

namespace {

/// Returns a scalar attribute as text; empty if it does not exist or is neither text nor a number.
/// @param most  upper limit on the length of a text [bytes], since a damaged header can declare any length
std::string attribute_text(hid_t object, std::string const& name, std::uint64_t most) {
  if (H5Aexists(object, name.c_str()) <= 0) return {};
  Id const opened(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
  Id const type(H5Aget_type(opened), H5Tclose);
  Id const space(H5Aget_space(opened), H5Sclose);
  hssize_t const count = H5Sget_simple_extent_npoints(space);
  if (count != 1) return {};
  H5T_class_t const kind = H5Tget_class(type);
  if (kind == H5T_STRING && H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    Id const memory(H5Tcopy(type), H5Tclose);
    if (H5Aread(opened, memory, &text) < 0 || !text) return {};
    std::string const value = text;
    H5free_memory(text);
    return value;
  }
  if (kind == H5T_STRING) {
    if (H5Tget_size(type) > most) return {};  // the file is damaged
    std::string value(H5Tget_size(type), '\0');
    if (H5Aread(opened, type, value.data()) < 0) return {};
    value = value.substr(0, value.find('\0'));
    if (H5Tget_strpad(type) == H5T_STR_SPACEPAD) value.erase(value.find_last_not_of(' ') + 1);
    return value;
  }
  if (kind == H5T_INTEGER && H5Tget_sign(type) == H5T_SGN_NONE) {
    std::uint64_t value = 0;
    return H5Aread(opened, H5T_NATIVE_UINT64, &value) < 0 ? std::string() : std::to_string(value);
  }
  if (kind == H5T_INTEGER) {
    std::int64_t value = 0;
    return H5Aread(opened, H5T_NATIVE_INT64, &value) < 0 ? std::string() : std::to_string(value);
  }
  if (kind != H5T_FLOAT) return {};
  double value = 0.0;
  if (H5Aread(opened, H5T_NATIVE_DOUBLE, &value) < 0) return {};
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

}  // namespace

std::string Hdf5Reader::attribute(std::string const& name) const {
  Lock const lock(library_lock());
  return attribute_text(handle_->file, name, handle_->bytes);
}

std::string Hdf5Reader::attribute_of(std::string const& dataset, std::string const& name) const {
  Lock const lock(library_lock());
  return attribute_text(handle_->open(path_, dataset), name, handle_->bytes);
}

std::vector<double> Hdf5Reader::number_attribute(std::string const& dataset, std::string const& name) const {
  Lock const lock(library_lock());
  Id const opened = handle_->open(path_, dataset);
  if (H5Aexists(opened, name.c_str()) <= 0) return {};
  Id const attribute(H5Aopen(opened, name.c_str(), H5P_DEFAULT), H5Aclose);
  Id const type(H5Aget_type(attribute), H5Tclose);
  Id const space(H5Aget_space(attribute), H5Sclose);
  H5T_class_t const kind = H5Tget_class(type);
  hssize_t const count = H5Sget_simple_extent_npoints(space);
  constexpr hssize_t most = 1000;  // a damaged header can declare any number
  if ((kind != H5T_INTEGER && kind != H5T_FLOAT) || count < 1 || count > most) return {};
  std::vector<double> values(static_cast<std::size_t>(count));
  if (H5Aread(attribute, H5T_NATIVE_DOUBLE, values.data()) < 0) return {};
  return values;
}

}  // namespace gladstone::inline files
