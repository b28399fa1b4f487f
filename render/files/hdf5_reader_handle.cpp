#include "render/files/hdf5_reader_handle.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <limits>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/nearest_name.h"

namespace gladstone::inline files::hdf5 {
namespace {

/// Returns true for a record of two floating-point numbers, as h5py stores complex numbers ("r" and "i").
bool is_complex(hid_t type) {
  if (H5Tget_class(type) != H5T_COMPOUND || H5Tget_nmembers(type) != 2) return false;
  return H5Tget_member_class(type, 0) == H5T_FLOAT && H5Tget_member_class(type, 1) == H5T_FLOAT;
}

herr_t collect_dataset(hid_t, char const* name, H5O_info_t const* info, void* names) {
  if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(names)->emplace_back(name);
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

}  // namespace

std::string sizes_text(std::vector<std::size_t> const& shape) {
  std::string text;
  for (std::size_t const size : shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text;
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

std::vector<std::string> all_datasets(hid_t file) {
  std::vector<std::string> names;
  H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, collect_dataset, &names);
  return names;
}

std::vector<std::size_t> shape_of(hid_t dataset) {
  Id const space(H5Dget_space(dataset), H5Sclose);
  int const rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> sizes(static_cast<std::size_t>(std::max(rank, 0)));
  if (rank > 0) H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
  return {sizes.begin(), sizes.end()};
}

void throw_unreadable(hid_t dataset, std::string const& path, std::string const& name) {
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

}  // namespace gladstone::inline files::hdf5

namespace gladstone::inline files {
using namespace hdf5;

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

}  // namespace gladstone::inline files
