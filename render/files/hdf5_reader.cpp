#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <set>

#include "render/base/available_memory.h"
#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/nearest_name.h"
#include "render/files/hdf5_file.h"
#include "render/files/hdf5_handle.h"
#include "render/files/input_file.h"

namespace gladstone::inline files {
using namespace hdf5;
namespace {

/// Formats a shape: "2000 x 1000 x 1000".
std::string sizes_text(std::vector<std::size_t> const& shape) {
  std::string text;
  for (std::size_t const size : shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text;
}

/// Returns true for a record of two floating-point numbers, as h5py stores complex numbers ("r" and "i").
bool is_complex(hid_t type) {
  if (H5Tget_class(type) != H5T_COMPOUND || H5Tget_nmembers(type) != 2) return false;
  return H5Tget_member_class(type, 0) == H5T_FLOAT && H5Tget_member_class(type, 1) == H5T_FLOAT;
}

std::string type_name(hid_t type) {
  switch (H5Tget_class(type)) {
    case H5T_FLOAT:
      return "floating-point numbers";
    case H5T_STRING:
      return "text";
    case H5T_COMPOUND:
      return is_complex(type) ? "complex numbers" : "compound records";
    case H5T_ENUM:
      return "enumerated values";
    case H5T_ARRAY:
      return "arrays";
    case H5T_VLEN:
      return "lists of varying length";
    default:
      return "something else";
  }
}

herr_t collect_dataset(hid_t, char const* name, H5O_info_t const* info, void* names) {
  if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

std::vector<std::string> all_datasets(hid_t file) {
  std::vector<std::string> names;
  H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, collect_dataset, &names);
  return names;
}

/// H5Lvisit callback that collects the names of all links below a group: hard links in list 0, soft and external ones
/// in list 1. Linked groups are not entered.
herr_t collect_link(hid_t, char const* name, H5L_info_t const* info, void* names) {
  bool const direct = info->type == H5L_TYPE_HARD;
  auto& lists = *static_cast<std::array<std::vector<std::string>, 2>*>(names);
  lists[direct ? 0 : 1].emplace_back(name);
  return 0;
}

/// Returns the name of a compression filter, from the most common registered filters of HDF5 (portal.hdfgroup.org,
/// "Registered Filter Plugins") or else from the file.
std::string filter_name(H5Z_filter_t filter, std::string const& written) {
  struct Known {
    int filter;
    char const* name;
  };
  constexpr std::array known{
      Known{H5Z_FILTER_SZIP, "szip"}, Known{305, "lzo"},   Known{307, "bzip2"},        Known{32000, "lzf"},
      Known{32001, "blosc"},          Known{32004, "lz4"}, Known{32008, "bitshuffle"}, Known{32013, "zfp"},
      Known{32015, "zstd"},           Known{32017, "sz"},  Known{32018, "fcidecomp"},  Known{32024, "sz3"},
      Known{32026, "blosc2"}};
  auto const* const found =
      std::find_if(known.begin(), known.end(), [filter](Known const& one) { return one.filter == filter; });
  std::string const name = found != known.end() ? found->name : written.substr(0, written.find(' '));
  return name.empty() ? "number " + std::to_string(filter) : name + " (number " + std::to_string(filter) + ')';
}

/// Throws DataError with the reason why a dataset cannot be read: filters that are not installed, else damage.
[[noreturn]] void throw_unreadable(hid_t dataset, std::string const& path, std::string const& name) {
  std::string missing;
  Id const created(H5Dget_create_plist(dataset), H5Pclose);
  for (int i = 0; i < H5Pget_nfilters(created); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t count = 0;
    std::array<char, 64> written{};
    H5Z_filter_t const filter = H5Pget_filter2(created, static_cast<unsigned>(i), &flags, &count, nullptr,
                                               written.size() - 1, written.data(), &config);
    if (filter < 0 || H5Zfilter_avail(filter) > 0) continue;
    missing += (missing.empty() ? "" : ", ") + filter_name(filter, written.data());
  }
  if (missing.empty()) {
    throw DataError(ErrorCode::damaged, path,
                    "dataset \"" + name + "\" cannot be read (the file is damaged or cut short)");
  }
  throw DataError(ErrorCode::unsupported, path,
                  "dataset \"" + name + "\" is compressed by a filter that is not installed here: " + missing +
                      "; rewrite it where the filter is, h5repack -f GZIP=4 " + path +
                      " repacked.h5, or name the folder of the filter's plugin in HDF5_PLUGIN_PATH");
}

}  // namespace

struct Hdf5Reader::Handle {
  Id file;
  std::uint64_t bytes = 0;  ///< size of the file [bytes]
  std::string rows_name;    ///< dataset of the last read_rows(), kept open for its chunk cache
  Id rows{H5I_INVALID_HID, H5Dclose};

  /// Opens a numeric dataset. @throws DataError
  Id open(std::string const& path, std::string const& dataset, bool integers_only = false) const;
  /// Opens a dataset for reading by rows. Its cache holds all chunks that intersect a row, up to 128 MiB, so that each
  /// chunk is decompressed once whatever the number of rows per call.
  hid_t open_rows(std::string const& path, std::string const& dataset);
  /// Reads a box of the dataset opened by open_rows(); `out` has exactly its size. @throws DataError
  void read(std::string const& path, std::string const& dataset, std::vector<hsize_t> const& start,
            std::vector<hsize_t> const& size, std::span<double> out) const;
};

namespace {

std::vector<std::size_t> shape_of(hid_t dataset) {
  Id const space(H5Dget_space(dataset), H5Sclose);
  int const rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> sizes(static_cast<std::size_t>(std::max(rank, 0)));
  if (rank > 0) H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
  return {sizes.begin(), sizes.end()};
}

/// Size up to which a dataset is read without checking the file's size [bytes], since unwritten parts are not stored.
constexpr double believed_dataset_bytes = 64e6;

/// Returns the largest possible compression ratio of a dataset's filters: 1032 for deflate, which szip does not reach;
/// infinite for filters that can reduce constant data to nothing.
double largest_packing(hid_t created) {
  double packing = 1;
  for (int i = 0; i < H5Pget_nfilters(created); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t parameters = 0;
    H5Z_filter_t const filter =
        H5Pget_filter2(created, static_cast<unsigned>(i), &flags, &parameters, nullptr, 0, nullptr, &config);
    if (filter == H5Z_FILTER_SHUFFLE || filter == H5Z_FILTER_FLETCHER32) continue;
    bool const bounded = filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_SZIP;
    packing *= bounded ? 1032 : std::numeric_limits<double>::infinity();
  }
  return packing;
}

/// Throws DataError if the file is too short to contain the dataset that its header declares.
/// @param file_bytes  size of the file
void require_stored(hid_t dataset, double file_bytes, std::string const& path, std::string const& name) {
  Id const type(H5Dget_type(dataset), H5Tclose), created(H5Dget_create_plist(dataset), H5Pclose);
  auto const shape = shape_of(dataset);
  double const value = static_cast<double>(H5Tget_size(type));
  double const stored = std::accumulate(shape.begin(), shape.end(), value, std::multiplies<>());
  double chunk_bytes = 0;
  if (H5Pget_layout(created) == H5D_CHUNKED) {
    std::vector<hsize_t> chunk(shape.size());
    H5Pget_chunk(created, static_cast<int>(chunk.size()), chunk.data());
    chunk_bytes = std::accumulate(chunk.begin(), chunk.end(), value, std::multiplies<>());
  }
  bool const elsewhere = H5Pget_external_count(created) > 0 || H5Pget_layout(created) == H5D_VIRTUAL;
  double const most = std::max(believed_dataset_bytes, file_bytes * largest_packing(created));
  if (elsewhere || std::max(stored, chunk_bytes) <= most) return;
  throw DataError(ErrorCode::damaged, path,
                  "dataset \"" + name + "\" of " + sizes_text(shape) + " values cannot be read (the file of " +
                      std::to_string(static_cast<long long>(file_bytes)) +
                      " bytes is too short to hold them: it is damaged or cut short, or most of them were never "
                      "written); copy it again, or write it anew");
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

Id Hdf5Reader::Handle::open(std::string const& path, std::string const& dataset, bool integers_only) const {
  Id opened(H5Dopen2(file, dataset.c_str(), H5P_DEFAULT), H5Dclose);
  if (!opened.valid()) {
    auto names = all_datasets(file);
    std::string message = "has no dataset \"" + dataset + '"';
    if (names.empty()) throw DataError(ErrorCode::missing_content, path, message + "; it has no datasets");
    if (auto const nearest = nearest_name(dataset, names)) message += "; did you mean \"" + *nearest + "\"?";
    constexpr std::size_t most = 20;
    bool const cut = names.size() > most;
    if (cut) names.resize(most);
    throw DataError(
        ErrorCode::missing_content, path,
        message + (message.ends_with('?') ? " It has " : "; it has ") + quoted_list(names) + (cut ? " and more" : ""));
  }
  require_stored(opened, static_cast<double>(bytes), path, dataset);
  Id const type(H5Dget_type(opened), H5Tclose);
  H5T_class_t const kind = H5Tget_class(type);
  if (kind != H5T_INTEGER && (kind != H5T_FLOAT || integers_only)) {
    throw DataError(ErrorCode::wrong_type, path,
                    "dataset \"" + dataset + "\" holds " + type_name(type) + "; " + (integers_only ? "whole " : "") +
                        "numbers are needed");
  }
  return opened;
}

hid_t Hdf5Reader::Handle::open_rows(std::string const& path, std::string const& dataset) {
  if (rows.valid() && rows_name == dataset) return rows;
  Id opened = open(path, dataset);
  Id const created(H5Dget_create_plist(opened), H5Pclose);
  auto const shape = shape_of(opened);
  if (H5Pget_layout(created) == H5D_CHUNKED && !shape.empty()) {
    std::vector<hsize_t> chunk(shape.size());
    H5Pget_chunk(created, static_cast<int>(chunk.size()), chunk.data());
    Id const type(H5Dget_type(opened), H5Tclose);
    std::size_t row_bytes = H5Tget_size(type) * chunk[0];
    for (std::size_t axis = 1; axis < shape.size(); ++axis) {
      row_bytes *= (shape[axis] + chunk[axis] - 1) / chunk[axis] * chunk[axis];
    }
    constexpr std::size_t slots = 12289, most = 128 * 1024 * 1024;
    Id const access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(access, slots, std::clamp<std::size_t>(row_bytes, 1024 * 1024, most), 1.0);
    opened.reset();
    opened = Id(H5Dopen2(file, dataset.c_str(), access), H5Dclose);
  }
  rows = std::move(opened);
  rows_name = dataset;
  return rows;
}

void Hdf5Reader::Handle::read(std::string const& path, std::string const& dataset, std::vector<hsize_t> const& start,
                              std::vector<hsize_t> const& size, std::span<double> out) const {
  throw_if_interrupted();
  GLADSTONE_EXPECTS(out.size() == product({size.begin(), size.end()}));
  if (out.empty()) return;
  Id const on_disk(H5Dget_space(rows), H5Sclose);
  H5Sselect_hyperslab(on_disk, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
  Id const in_memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  if (H5Dread(rows, H5T_NATIVE_DOUBLE, in_memory, on_disk, H5P_DEFAULT, out.data()) < 0) {
    throw_unreadable(rows, path, dataset);
  }
}

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
