#include <hdf5.h>

#include <chrono>
#include <cstring>
#include <ctime>
#include <span>
#include <type_traits>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/version.h"
#include "render/files/hdf5_chunks.h"
#include "render/files/hdf5_file.h"
#include "render/files/hdf5_handle.h"
#include "render/files/hdf5_objects.h"
#include "render/files/output_file.h"

namespace gladstone {
using namespace hdf5;

/// State of a file being written. An in-memory file is written to disk by close(), with calls whose errors are checked:
/// HDF5 itself does not recover from a full disk (it tries to flush again on every attempt to close, and at exit). For
/// an on-disk file the free space is checked before each write.
struct Hdf5Writer::Handle {
  OutputFile output;
  Id file;
  SourceFiles sources;
  Hdf5Growth growth;
  ChunkDeflater deflater;
};

namespace {

/// Size above which a dataset is compressed [bytes]; for smaller ones the chunk tables cost more than compression
/// saves.
constexpr std::size_t compressed_from_bytes = 64 * 1024;
/// Level of deflate of datasets that are written row by row, such as volumes, which may compress well.
constexpr int row_deflate_level = 4;

/// Enables chunks with byte shuffling and deflate.
void set_deflated(hid_t properties, std::vector<std::size_t> const& chunk, int level) {
  std::vector<hsize_t> const sizes(chunk.begin(), chunk.end());
  H5Pset_chunk(properties, static_cast<int>(sizes.size()), sizes.data());
  H5Pset_shuffle(properties);
  H5Pset_deflate(properties, level);
}

void write_chunks(hid_t dataset, std::vector<DeflatedChunk> const& chunks, std::string const& path,
                  std::string const& name) {
  for (DeflatedChunk const& chunk : chunks) {
    std::vector<hsize_t> const start(chunk.start.begin(), chunk.start.end());
    check(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, start.data(), chunk.bytes.size(), chunk.bytes.data()) >= 0, path,
          "dataset \"" + name + '"');
  }
}

template <class Value>
hid_t hdf5_type() {
  if (std::is_same_v<Value, double>) return H5T_NATIVE_DOUBLE;
  return std::is_same_v<Value, std::int64_t> ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT16;
}

/// Text attributes of a dataset.
struct DatasetTexts {
  std::string const &units, &description, &axes;
};

template <class Value>
void write_dataset(hid_t file, ChunkDeflater& deflater, std::string const& path, std::string const& dataset,
                   std::span<Value const> values, std::vector<std::size_t> const& shape, DatasetTexts const& texts) {
  bool const compressed = values.size_bytes() > compressed_from_bytes;
  std::vector<std::size_t> chunk;
  std::vector<DeflatedChunk> chunks;
  if (compressed) {  // before locking, so that several threads compress at the same time
    chunk = chunk_shape(shape, sizeof(Value));
    chunks = deflater.deflate(values.data(), shape, chunk, sizeof(Value));
  }
  Lock const lock(library_lock());
  make_groups(file, path, dataset);
  std::vector<hsize_t> const sizes(shape.begin(), shape.end());
  Id const space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose);
  Id const properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, false);
  if (compressed) set_deflated(properties, chunk, deflate_level);
  Id const created(H5Dcreate2(file, dataset.c_str(), hdf5_type<Value>(), space, H5P_DEFAULT, properties, H5P_DEFAULT),
                   H5Dclose);
  bool good = created.valid();
  if (good && !compressed && product(shape) > 0)
    good = H5Dwrite(created, hdf5_type<Value>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0;
  check(good, path, "dataset \"" + dataset + '"');
  write_chunks(created, chunks, path, dataset);
  write_attribute(created, path, "units", texts.units);
  write_attribute(created, path, "description", texts.description);
  write_attribute(created, path, "axes", texts.axes);
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

Hdf5Writer::Hdf5Writer(std::string const& path, FileOrigin const& origin, Hdf5Growth growth) : path_(path) {
  // Before locking, since it accesses the disk.
  handle_.reset(new Handle{OutputFile(path, origin.filetype), Id(H5I_INVALID_HID, H5Fclose), origin.sources, growth,
                           ChunkDeflater(growth == Hdf5Growth::in_memory)});
  Lock const lock(library_lock());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::string const temporary = handle_->output.temporary_path();
  Id const access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (growth == Hdf5Growth::in_memory) {
    H5Pset_fapl_core(access, max_chunk_bytes, false);
  } else {
    require_space(path, temporary, 0);
#if H5_VERSION_GE(1, 10, 7)
    H5Pset_file_locking(access, false, true);  // a Partial has its own lock
#endif
  }
  Id const properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, false);
  std::string const& place = growth == Hdf5Growth::in_memory ? path : temporary;
  handle_->file = Id(H5Fcreate(place.c_str(), H5F_ACC_TRUNC, properties, access), H5Fclose);
  check(handle_->file.valid(), path, "the HDF5 structure");
  hid_t const root = handle_->file;
  std::int64_t const format_version = origin.version;
  write_attribute(root, path, "filetype", origin.filetype);
  write_attribute(root, path, "version", H5T_NATIVE_INT64, &format_version);
  write_attribute(root, path, "software_version", std::string(gladstone::version));
  write_attribute(root, path, "git_sha1", std::string(gladstone::git_sha1));
  write_attribute(root, path, "date_and_time", date_and_time());
  write_attribute(root, path, "setup", origin.setup);
  write_attribute(root, path, "seed", H5T_NATIVE_UINT64, &origin.seed);
  write_attribute(root, path, "device", origin.device);
  for (SourceFiles::Source const& source : origin.sources.all()) {
    if (!source.name.empty()) attribute("/", source.name + "_sha256", source.sha256);
  }
}

Hdf5Writer::~Hdf5Writer() {
  Lock const lock(library_lock());
  handle_.reset();
}

void Hdf5Writer::write(std::string const& dataset, std::span<double const> data, std::vector<std::size_t> const& shape,
                       std::string const& units, std::string const& description, std::string const& axes) {
  GLADSTONE_EXPECTS(handle_ && product(shape) == data.size());
  if (handle_->growth == Hdf5Growth::on_disk) require_space(path_, handle_->output.temporary_path(), data.size_bytes());
  write_dataset(handle_->file, handle_->deflater, path_, dataset, data, shape, {units, description, axes});
}

void Hdf5Writer::write(std::string const& dataset, std::span<std::int64_t const> data,
                       std::vector<std::size_t> const& shape, std::string const& units, std::string const& description,
                       std::string const& axes) {
  GLADSTONE_EXPECTS(handle_ && product(shape) == data.size());
  if (handle_->growth == Hdf5Growth::on_disk) require_space(path_, handle_->output.temporary_path(), data.size_bytes());
  write_dataset(handle_->file, handle_->deflater, path_, dataset, data, shape, {units, description, axes});
}

template <class Value>
void Hdf5Writer::make_rows(std::string const& dataset, std::vector<std::size_t> const& shape,
                           std::vector<std::size_t> const& chunk, std::string const& units,
                           std::string const& description, std::string const& axes) {
  Lock const lock(library_lock());
  GLADSTONE_EXPECTS(handle_ && chunk.size() == shape.size());
  make_groups(handle_->file, path_, dataset);
  std::vector<hsize_t> const sizes(shape.begin(), shape.end());
  Id const space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose);
  Id const properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, false);
  if (product(shape) > 0) set_deflated(properties, chunk, row_deflate_level);
  Id const created(
      H5Dcreate2(handle_->file, dataset.c_str(), hdf5_type<Value>(), space, H5P_DEFAULT, properties, H5P_DEFAULT),
      H5Dclose);
  check(created.valid(), path_, "dataset \"" + dataset + '"');
  write_attribute(created, path_, "units", units);
  write_attribute(created, path_, "description", description);
  write_attribute(created, path_, "axes", axes);
}

template <class Value>
void Hdf5Writer::write_rows(std::string const& dataset, std::size_t first, std::span<Value const> data) {
  Lock const lock(library_lock());
  GLADSTONE_EXPECTS(handle_ != nullptr);
  if (data.empty()) return;
  if (handle_->growth == Hdf5Growth::on_disk) require_space(path_, handle_->output.temporary_path(), data.size_bytes());
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
  check(H5Dwrite(opened, hdf5_type<Value>(), in_memory, on_disk, H5P_DEFAULT, data.data()) >= 0, path_,
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
  Lock const lock(library_lock());
  GLADSTONE_EXPECTS(handle_ != nullptr);
  write_attribute(open_object(handle_->file, path_, object, name), path_, name, value);
}

void Hdf5Writer::attribute(std::string const& object, std::string const& name, double value) {
  Lock const lock(library_lock());
  GLADSTONE_EXPECTS(handle_ != nullptr);
  write_attribute(open_object(handle_->file, path_, object, name), path_, name, H5T_NATIVE_DOUBLE, &value);
}

void Hdf5Writer::attribute(std::string const& object, std::string const& name, std::int64_t value) {
  Lock const lock(library_lock());
  GLADSTONE_EXPECTS(handle_ != nullptr);
  write_attribute(open_object(handle_->file, path_, object, name), path_, name, H5T_NATIVE_INT64, &value);
}

void Hdf5Writer::attach_scales(std::vector<ScaledDataset> const& datasets) {
  Lock const lock(library_lock());
  GLADSTONE_EXPECTS(handle_ != nullptr);
  check(hdf5::attach_scales(handle_->file, datasets), path_, "the dimension scales");
}

void Hdf5Writer::close() {
  GLADSTONE_EXPECTS(handle_ != nullptr);
  bool const in_memory = handle_->growth == Hdf5Growth::in_memory;
  ssize_t size = 0;
  {
    Lock const lock(library_lock());
    check(H5Fflush(handle_->file, H5F_SCOPE_GLOBAL) >= 0, path_, "the HDF5 structure");
    if (in_memory) size = H5Fget_file_image(handle_->file, nullptr, 0);
    check(size > 0 || !in_memory, path_, "the HDF5 structure");
  }
  std::vector<char> image(static_cast<std::size_t>(size));  // without lock, since fresh memory takes time
  {
    Lock const lock(library_lock());
    check(!in_memory || H5Fget_file_image(handle_->file, image.data(), image.size()) == size, path_,
          "the HDF5 structure");
    handle_->file.reset();
  }
  // Several threads write to the disk at the same time.
  if (in_memory) handle_->output.write(image.data(), image.size());
  handle_->sources.check();
  handle_->output.commit();
  handle_.reset();
}

}  // namespace gladstone
