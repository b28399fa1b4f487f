#include <hdf5.h>

#include <chrono>
#include <ctime>
#include <span>
#include <type_traits>
#include <utility>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/files/hdf5_chunks.h"
#include "render/files/hdf5_content.h"
#include "render/files/hdf5_file.h"
#include "render/files/hdf5_handle.h"
#include "render/files/hdf5_objects.h"
#include "render/files/output_file.h"

namespace gladstone::inline files {
using namespace hdf5;

/// State of a file being written. The content of an in-memory file is retained until close() writes it to disk, with
/// calls whose errors are checked: HDF5 itself does not recover from a full disk (it tries to flush again on every
/// attempt to close, and at exit). For an on-disk file the free space is checked before each write.
struct Hdf5Writer::Handle {
  OutputFile output;
  Hdf5Growth growth;
  HeldContent content;  ///< content of a file held in memory; of other files only the provenance
  Id file;              ///< on-disk file
  ChunkDeflater deflater;

  bool in_memory() const { return growth == Hdf5Growth::in_memory; }
  void create_on_disk(std::string const& path);
  template <class Value>
  void add(std::string const& path, HeldDataset dataset, std::span<Value const> values);
  void add(std::string const& path, HeldAttribute attribute);
};

namespace {

/// Size above which a dataset is compressed [bytes]; for smaller ones the chunk tables cost more than compression
/// saves.
constexpr std::size_t compressed_from_bytes = 64 * 1024;
/// Level of deflate of datasets that are written row by row, such as volumes, which may compress well.
constexpr int row_deflate_level = 4;

template <class Value>
constexpr ValueType value_type() {
  if (std::is_same_v<Value, double>) return ValueType::float64;
  return std::is_same_v<Value, std::int64_t> ? ValueType::int64 : ValueType::uint16;
}

/// Free space required in addition to the data, for HDF5's tables [bytes].
constexpr std::uintmax_t spare_bytes = 8 * 1024 * 1024;

/// @throws OutputError if the disk of an on-disk file lacks space for the data
void require_space(std::string const& path, std::string const& temporary, std::size_t bytes) {
  std::error_code error;
  auto const space = std::filesystem::space(std::filesystem::path(temporary).parent_path(), error);
  if (error || space.available >= bytes + spare_bytes) return;
  throw OutputError(path, "cannot be written (" + std::to_string(space.available / (1024 * 1024)) +
                              " MiB are free on the disk); free more space, or write to another disk");
}

/// Returns the current time in UTC as ISO 8601 text.
std::string date_and_time() {
  std::time_t const now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace

void Hdf5Writer::Handle::create_on_disk(std::string const& path) {
  Lock const lock(library_lock());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::string const temporary = output.temporary_path();
  require_space(path, temporary, 0);
  Id const access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
#if H5_VERSION_GE(1, 10, 7)
  H5Pset_file_locking(access, false, true);  // a Partial has its own lock
#endif
  Id const properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, false);
  file = Id(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, properties, access), H5Fclose);
  check(file.valid(), path, "the HDF5 structure");
  write_origin(file, path, content.origin);
}

template <class Value>
void Hdf5Writer::Handle::add(std::string const& path, HeldDataset dataset, std::span<Value const> values) {
  dataset.type = value_type<Value>();
  if (values.size_bytes() > compressed_from_bytes) {  // compress before locking, so that several threads work at the
                                                      // same time
    dataset.chunk = chunk_shape(dataset.shape, sizeof(Value));
    dataset.chunks = deflater.deflate(values.data(), dataset.shape, dataset.chunk, sizeof(Value));
  } else {
    auto const* const bytes = reinterpret_cast<unsigned char const*>(values.data());
    dataset.values.assign(bytes, bytes + values.size_bytes());
  }
  if (in_memory()) {
    content.datasets.push_back(std::move(dataset));
    return;
  }
  require_space(path, output.temporary_path(), values.size_bytes());
  Lock const lock(library_lock());
  create_dataset(file, path, dataset, deflate_level);
  fill_dataset(file, path, dataset);
}

void Hdf5Writer::Handle::add(std::string const& path, HeldAttribute attribute) {
  if (in_memory()) {
    content.attributes.push_back(std::move(attribute));
    return;
  }
  Lock const lock(library_lock());
  set_attribute(file, path, attribute);
}

Hdf5Writer::Hdf5Writer(std::string const& path, FileOrigin const& origin, Hdf5Growth growth) : path_(path) {
  handle_.reset(new Handle{OutputFile(path, origin.filetype),
                           growth,
                           {origin, {}, {}, {}},
                           Id(H5I_INVALID_HID, H5Fclose),
                           ChunkDeflater(growth == Hdf5Growth::in_memory)});
  if (!handle_->in_memory()) handle_->create_on_disk(path);
  attribute("/", "date_and_time", date_and_time());
  for (SourceFiles::Source const& source : origin.sources.all()) {
    if (!source.name.empty()) attribute("/", source.name + "_sha256", source.sha256);
  }
}

Hdf5Writer::~Hdf5Writer() {
  if (!handle_) return;
  Lock const lock(library_lock());
  handle_->file.reset();
}

void Hdf5Writer::write(std::string const& dataset, std::span<double const> data, std::vector<std::size_t> const& shape,
                       std::string const& units, std::string const& description, std::string const& axes) {
  GLADSTONE_EXPECTS(handle_ && product(shape) == data.size());
  handle_->add(path_, {dataset, {}, shape, units, description, axes, {}, {}, {}}, data);
}

void Hdf5Writer::write(std::string const& dataset, std::span<std::int64_t const> data,
                       std::vector<std::size_t> const& shape, std::string const& units, std::string const& description,
                       std::string const& axes) {
  GLADSTONE_EXPECTS(handle_ && product(shape) == data.size());
  handle_->add(path_, {dataset, {}, shape, units, description, axes, {}, {}, {}}, data);
}

template <class Value>
void Hdf5Writer::make_rows(std::string const& dataset, std::vector<std::size_t> const& shape,
                           std::vector<std::size_t> const& chunk, std::string const& units,
                           std::string const& description, std::string const& axes) {
  GLADSTONE_EXPECTS(handle_ && !handle_->in_memory() && chunk.size() == shape.size());
  HeldDataset rows{dataset, value_type<Value>(), shape, units, description, axes, {}, {}, {}};
  if (product(shape) > 0) rows.chunk = chunk;
  Lock const lock(library_lock());
  create_dataset(handle_->file, path_, rows, row_deflate_level);
}

template <class Value>
void Hdf5Writer::write_rows(std::string const& dataset, std::size_t first, std::span<Value const> data) {
  GLADSTONE_EXPECTS(handle_ && !handle_->in_memory());
  if (data.empty()) return;
  Lock const lock(library_lock());
  require_space(path_, handle_->output.temporary_path(), data.size_bytes());
  Id const opened(H5Dopen2(handle_->file, dataset.c_str(), H5P_DEFAULT), H5Dclose);
  check(opened.valid(), path_, "dataset \"" + dataset + '"');
  Id const on_disk(H5Dget_space(opened), H5Sclose);
  std::vector<hsize_t> size(static_cast<std::size_t>(H5Sget_simple_extent_ndims(on_disk)));
  H5Sget_simple_extent_dims(on_disk, size.data(), nullptr);
  std::vector<hsize_t> start(size.size(), 0);
  start[0] = first;
  size[0] = 1;
  size[0] = data.size() / product({size.begin(), size.end()});
  GLADSTONE_EXPECTS(product({size.begin(), size.end()}) == data.size());
  H5Sselect_hyperslab(on_disk, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
  Id const in_memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  check(H5Dwrite(opened, native_type(value_type<Value>()), in_memory, on_disk, H5P_DEFAULT, data.data()) >= 0, path_,
        "dataset \"" + dataset + '"');
}

template void Hdf5Writer::make_rows<std::uint16_t>(std::string const&, std::vector<std::size_t> const&,
                                                   std::vector<std::size_t> const&, std::string const&,
                                                   std::string const&, std::string const&);
template void Hdf5Writer::make_rows<double>(std::string const&, std::vector<std::size_t> const&,
                                            std::vector<std::size_t> const&, std::string const&, std::string const&,
                                            std::string const&);
template void Hdf5Writer::write_rows<std::uint16_t>(std::string const&, std::size_t, std::span<std::uint16_t const>);
template void Hdf5Writer::write_rows<double>(std::string const&, std::size_t, std::span<double const>);

void Hdf5Writer::attribute(std::string const& object, std::string const& name, std::string const& value) {
  GLADSTONE_EXPECTS(handle_ != nullptr);
  handle_->add(path_, {object, name, value});
}

void Hdf5Writer::attribute(std::string const& object, std::string const& name, double value) {
  GLADSTONE_EXPECTS(handle_ != nullptr);
  handle_->add(path_, {object, name, value});
}

void Hdf5Writer::attribute(std::string const& object, std::string const& name, std::int64_t value) {
  GLADSTONE_EXPECTS(handle_ != nullptr);
  handle_->add(path_, {object, name, value});
}

void Hdf5Writer::attach_scales(std::vector<ScaledDataset> const& datasets) {
  GLADSTONE_EXPECTS(handle_ != nullptr);
  if (handle_->in_memory()) {
    handle_->content.scales = datasets;
    return;
  }
  Lock const lock(library_lock());
  check(hdf5::attach_scales(handle_->file, datasets), path_, "the dimension scales");
}

void Hdf5Writer::close() {
  GLADSTONE_EXPECTS(handle_ != nullptr);
  SourceFiles const sources = handle_->content.origin.sources;
  if (handle_->in_memory()) {
    std::vector<char> const image = make_file_image(path_, std::move(handle_->content));
    handle_->output.write(image.data(), image.size());  // several threads write to the disk at the same time
  } else {
    Lock const lock(library_lock());
    check(H5Fflush(handle_->file, H5F_SCOPE_GLOBAL) >= 0, path_, "the HDF5 structure");
    handle_->file.reset();
  }
  sources.check();
  handle_->output.commit();
  handle_.reset();
}

}  // namespace gladstone::inline files
