#include "render/files/source_files.h"

#include <algorithm>
#include <bit>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/hdf5_file.h"
#include "render/files/image_file.h"
#include "render/files/input_file.h"
#include "render/files/sha256.h"

namespace gladstone::inline files {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are hashed as stored in memory");

Sha256 started_picture(int columns, int rows, int sample_bits, char const* numbers) {
  Sha256 hash;
  hash.add("gladstone pixels " + std::to_string(columns) + ' ' + std::to_string(rows) + ' ' +
           std::to_string(sample_bits) + ' ' + numbers + '\n');
  return hash;
}

void add_dataset(Sha256& hash, Hdf5Reader const& file, std::string const& path, std::string const& name) {
  std::vector<std::size_t> const shape = file.shape(name);
  std::string head = "gladstone dataset " + name;
  std::size_t count = 1;
  for (std::size_t const size : shape) {
    head += ' ' + std::to_string(size);
    count *= size;
  }
  hash.add(head + '\n');
  if (count == 0) return;
  if (shape.empty()) {
    std::vector<double> const value = file.read(name);
    hash.add(value.data(), value.size() * sizeof(double));
    return;
  }
  constexpr std::size_t most = std::size_t{1} << 20;  // number of values per read
  std::size_t const row = count / shape[0], rows = std::max<std::size_t>(1, most / row);
  // A damaged header can declare any size.
  require_memory(path, "a row of dataset \"" + name + '"', 1.0 * sizeof(double) * static_cast<double>(row));
  std::vector<double> values;
  for (std::size_t first = 0; first < shape[0]; first += rows) {
    throw_if_interrupted();
    values.resize(std::min(rows, shape[0] - first) * row);
    file.read_rows(name, first, values.size() / row, values);
    hash.add(values.data(), values.size() * sizeof(double));
  }
}

std::string compute_hash(std::string const& path, SourceFiles::Holds holds) {
  switch (holds) {
    case SourceFiles::Holds::pixels:
      return pixel_sha256(path);
    case SourceFiles::Holds::datasets:
      return dataset_sha256(path);
    case SourceFiles::Holds::bytes:
      break;
  }
  return byte_sha256(path);
}

}  // namespace

std::string pixel_sha256(Image<double> const& picture, int sample_bits) {
  std::vector<std::uint16_t> whole(picture.size());
  int others = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    double const value = picture.data()[i];
    whole[i] = static_cast<std::uint16_t>(value >= 0 && value <= 65535 ? value : 0);
    others |= static_cast<double>(whole[i]) != value;
  }
  Sha256 hash = started_picture(picture.columns(), picture.rows(), sample_bits, others ? "float64" : "uint16");
  if (others) {
    hash.add(picture.data(), picture.size() * sizeof(double));
  } else {
    hash.add(whole.data(), whole.size() * sizeof(std::uint16_t));
  }
  return hash.finish();
}

std::string pixel_sha256(Image<std::uint16_t> const& picture, int sample_bits) {
  Sha256 hash = started_picture(picture.columns(), picture.rows(), sample_bits, "uint16");
  hash.add(picture.data(), picture.size() * sizeof(std::uint16_t));
  return hash.finish();
}

std::string pixel_sha256(std::string const& path) {
  ImageMetadata metadata;
  StoredLevels const levels = read_levels(path, &metadata);
  return std::visit([&](auto const& picture) { return pixel_sha256(picture, metadata.sample_bits); }, levels);
}

std::string dataset_sha256(std::string const& path) {
  Hdf5Reader const file(path);
  Sha256 hash;
  for (std::string const& name : file.number_datasets()) {
    std::string const last = name.substr(name.rfind('/') + 1);
    if (!last.starts_with("seconds_") && last != "device") add_dataset(hash, file, path, name);
  }
  return hash.finish();
}

bool has_hdf5_ending(std::string const& path) { return path.ends_with(".h5") || path.ends_with(".hdf5"); }

std::string byte_sha256(std::string const& path) {
  InputFile const file(path);
  Sha256 hash;
  std::vector<char> piece(std::size_t{1} << 20);
  for (std::uint64_t offset = 0;;) {
    std::size_t const size = file.read(offset, piece.data(), piece.size());
    hash.add(piece.data(), size);
    offset += size;
    if (size < piece.size()) return hash.finish();
  }
}

void SourceFiles::add(std::string name, std::string path, Holds holds) {
  auto const known = std::find_if(sources_.begin(), sources_.end(),
                                  [&](Source const& source) { return source.path == path && source.holds == holds; });
  std::string hash = known == sources_.end() ? compute_hash(path, holds) : known->sha256;
  add(std::move(name), std::move(path), holds, std::move(hash));
}

Image<double> SourceFiles::add_image(std::string name, std::string path) {
  ImageMetadata metadata;
  Image<double> image = read_image(path, &metadata);
  add(std::move(name), std::move(path), Holds::pixels, pixel_sha256(image, metadata.sample_bits));
  return image;
}

void SourceFiles::add(std::string name, std::string path) {
  Holds const holds = has_hdf5_ending(path) ? Holds::datasets : Holds::bytes;
  add(std::move(name), std::move(path), holds);
}

void SourceFiles::add(std::string name, std::string path, Holds holds, std::string sha256) {
  sources_.push_back({std::move(name), std::move(path), holds, std::move(sha256)});
}

void SourceFiles::add_known(std::string name, std::string sha256) {
  sources_.push_back({std::move(name), "", Holds::bytes, std::move(sha256)});
}

std::string SourceFiles::sha256(std::string const& name) const {
  auto const found =
      std::find_if(sources_.begin(), sources_.end(), [&](Source const& source) { return source.name == name; });
  return found == sources_.end() ? "" : found->sha256;
}

void SourceFiles::check() const {
  for (Source const& source : sources_) {
    if (source.path.empty()) continue;
    std::string what = "the SHA-256 of its content differs";
    try {
      if (compute_hash(source.path, source.holds) == source.sha256) continue;
    } catch (DataError const& error) {  // the file was removed, or partly overwritten
      if (error.code() == ErrorCode::memory) throw;
      what = "it cannot be read any more: " + error.message();
    }
    throw DataError(ErrorCode::changed, source.path,
                    "has changed since it was read (" + what + "), and nothing was written; " + advice_);
  }
}

}  // namespace gladstone::inline files
