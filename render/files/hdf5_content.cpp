#include "render/files/hdf5_content.h"

#include <hdf5.h>

#include <utility>

#include "render/base/version.h"
#include "render/files/hdf5_objects.h"

namespace gladstone::inline files::hdf5 {
namespace {

constexpr std::size_t most_skeletons = 4;

/// File in the memory of the HDF5 library, which is closed with the library locked.
class FileInMemory {
 public:
  FileInMemory() = default;
  FileInMemory(FileInMemory const&) = delete;
  ~FileInMemory() {
    Lock const lock(library_lock());
    file_.reset();
  }
  /// Creates an empty file. @pre the library is locked, as for all functions but the destructor
  void create(std::string const& path) {
    Id const access = access_properties();
    Id const properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_obj_track_times(properties, false);
    file_ = Id(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, properties, access), H5Fclose);
    check(file_.valid(), path, "the HDF5 structure");
  }
  /// Opens a copy of a file image.
  void open(std::string const& path, std::vector<char> image) {
    Id const access = access_properties();
    H5Pset_file_image(access, image.data(), image.size());
    std::string const name = path + "/image";  // HDF5 requires a name that does not exist
    file_ = Id(H5Fopen(name.c_str(), H5F_ACC_RDWR, access), H5Fclose);
    check(file_.valid(), path, "the HDF5 structure");
  }
  std::int64_t id() const { return file_; }
  /// Completes the file image. @return its size
  std::size_t flush(std::string const& path) {
    check(H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0, path, "the HDF5 structure");
    ssize_t const size = H5Fget_file_image(file_, nullptr, 0);
    check(size > 0, path, "the HDF5 structure");
    return static_cast<std::size_t>(size);
  }
  /// Copies the file image and closes the file. @param image  of the size that flush() returned
  void take_image(std::string const& path, std::vector<char>& image) {
    ssize_t const size = H5Fget_file_image(file_, image.data(), image.size());
    check(size == static_cast<ssize_t>(image.size()), path, "the HDF5 structure");
    file_.reset();
  }

 private:
  static Id access_properties() {
    Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fapl_core(access, max_chunk_bytes, false);
    return access;
  }

  Id file_{H5I_INVALID_HID, H5Fclose};
};

/// Returns everything that determines the structure of a file without values, as text.
std::string describe_structure(HeldContent const& content) {
  std::string text;
  auto const add = [&text](std::string const& part) { text.append(part).push_back('\0'); };
  FileOrigin const& origin = content.origin;
  for (std::string const& part :
       {origin.filetype, std::to_string(origin.version), origin.setup, std::to_string(origin.seed), origin.device})
    add(part);
  for (HeldDataset const& dataset : content.datasets) {
    for (std::string const& part : {dataset.name, std::to_string(static_cast<int>(dataset.type)), dataset.units,
                                    dataset.description, dataset.axes})
      add(part);
    for (std::size_t const size : dataset.shape) add(std::to_string(size));
    add("");
  }
  for (ScaledDataset const& scaled : content.scales) {
    add(scaled.dataset);
    for (std::string const& scale : scaled.scales) add(scale);
    add("");
  }
  return text;
}

std::vector<char> make_skeleton(std::string const& path, HeldContent const& content) {
  FileInMemory file;
  file.create(path);
  write_origin(file.id(), path, content.origin);
  for (HeldDataset const& dataset : content.datasets) create_dataset(file.id(), path, dataset, deflate_level);
  check(attach_scales(file.id(), content.scales), path, "the dimension scales");
  std::vector<char> image(file.flush(path));
  file.take_image(path, image);
  return image;
}

/// Returns a file with the groups, datasets and common attributes of a content, without values (skeleton). The latest
/// skeletons are retained.
std::vector<char> find_skeleton(std::string const& path, HeldContent const& content) {
  struct Skeleton {
    std::string structure;
    std::vector<char> image;
  };
  static std::vector<Skeleton> retained;
  std::string structure = describe_structure(content);
  for (Skeleton const& skeleton : retained)
    if (skeleton.structure == structure) return skeleton.image;
  std::vector<char> image = make_skeleton(path, content);
  if (retained.size() == most_skeletons) retained.erase(retained.begin());
  retained.push_back({std::move(structure), image});
  return image;
}

}  // namespace

std::int64_t native_type(ValueType type) {
  switch (type) {
    case ValueType::int64:
      return H5T_NATIVE_INT64;
    case ValueType::uint16:
      return H5T_NATIVE_UINT16;
    case ValueType::float64:
      break;
  }
  return H5T_NATIVE_DOUBLE;
}

void create_dataset(std::int64_t file, std::string const& path, HeldDataset const& dataset, int level) {
  make_groups(file, path, dataset.name);
  std::vector<hsize_t> const sizes(dataset.shape.begin(), dataset.shape.end());
  Id const space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose);
  Id const properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, false);
  if (!dataset.chunk.empty()) {
    std::vector<hsize_t> const chunk(dataset.chunk.begin(), dataset.chunk.end());
    H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
    H5Pset_shuffle(properties);
    H5Pset_deflate(properties, static_cast<unsigned>(level));
  }
  Id const created(
      H5Dcreate2(file, dataset.name.c_str(), native_type(dataset.type), space, H5P_DEFAULT, properties, H5P_DEFAULT),
      H5Dclose);
  check(created.valid(), path, "dataset \"" + dataset.name + '"');
  write_attribute(created, path, "units", dataset.units);
  write_attribute(created, path, "description", dataset.description);
  write_attribute(created, path, "axes", dataset.axes);
}

void fill_dataset(std::int64_t file, std::string const& path, HeldDataset const& dataset) {
  if (product(dataset.shape) == 0) return;
  Id const opened(H5Dopen2(file, dataset.name.c_str(), H5P_DEFAULT), H5Dclose);
  bool good = opened.valid();
  if (good && dataset.chunk.empty())
    good = H5Dwrite(opened, native_type(dataset.type), H5S_ALL, H5S_ALL, H5P_DEFAULT, dataset.values.data()) >= 0;
  for (DeflatedChunk const& chunk : dataset.chunks) {
    std::vector<hsize_t> const start(chunk.start.begin(), chunk.start.end());
    good = good && H5Dwrite_chunk(opened, H5P_DEFAULT, 0, start.data(), chunk.bytes.size(), chunk.bytes.data()) >= 0;
  }
  check(good, path, "dataset \"" + dataset.name + '"');
}

void set_attribute(std::int64_t file, std::string const& path, HeldAttribute const& attribute) {
  Id const object = open_object(file, path, attribute.object, attribute.name);
  if (auto const* const text = std::get_if<std::string>(&attribute.value))
    write_attribute(object, path, attribute.name, *text);
  else if (auto const* const number = std::get_if<double>(&attribute.value))
    write_attribute(object, path, attribute.name, H5T_NATIVE_DOUBLE, number);
  else
    write_attribute(object, path, attribute.name, H5T_NATIVE_INT64, &std::get<std::int64_t>(attribute.value));
}

void write_origin(std::int64_t file, std::string const& path, FileOrigin const& origin) {
  std::int64_t const format_version = origin.version;
  write_attribute(file, path, "filetype", origin.filetype);
  write_attribute(file, path, "version", H5T_NATIVE_INT64, &format_version);
  write_attribute(file, path, "software_version", std::string(gladstone::version));
  write_attribute(file, path, "git_sha1", std::string(gladstone::git_sha1));
  write_attribute(file, path, "setup", origin.setup);
  write_attribute(file, path, "seed", H5T_NATIVE_UINT64, &origin.seed);
  write_attribute(file, path, "device", origin.device);
}

std::vector<char> make_file_image(std::string const& path, HeldContent content) {
  FileInMemory file;
  std::vector<char> image;
  std::size_t size = 0;
  {
    Lock const lock(library_lock());
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    file.open(path, find_skeleton(path, content));
    for (HeldDataset& dataset : content.datasets) fill_dataset(file.id(), path, std::exchange(dataset, {}));
    for (HeldAttribute const& attribute : content.attributes) set_attribute(file.id(), path, attribute);
    size = file.flush(path);
  }
  image.resize(size);  // the library is not locked here, since allocating memory takes time
  Lock const lock(library_lock());
  file.take_image(path, image);
  return image;
}

}  // namespace gladstone::inline files::hdf5
