#include "render/base/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/image_codecs.h"
#include "render/base/input_file.h"
#include "render/base/interrupt.h"
#include "render/base/output_file.h"
#include "render/base/version.h"

namespace gladstone {
namespace {

/// First line of our ImageDescription, a TOML comment, so that a setup below it stays a setup:
/// "# gladstone image, bit_depth = 12, pixel_pitch_m = 1e-05"
constexpr std::string_view signature = "# gladstone image, bit_depth = ";
constexpr std::string_view pitch_label = ", pixel_pitch_m = ";

std::string described(ImageMetadata const& metadata) {
  return std::string(signature) + std::to_string(metadata.bit_depth) + std::string(pitch_label) +
         fmt::format("{:.15g}", metadata.pixel_pitch_m) + '\n' +
         metadata.description;  // of 10 um: 1e-05, no 9.99..e-06
}

/// The metadata from a description of ours; false for somebody else's.
bool parse_description(std::string const& text, ImageMetadata& metadata) {
  if (!text.starts_with(signature)) return false;
  std::size_t const line_end = std::min(text.find('\n'), text.size());
  std::size_t const pitch = text.find(pitch_label);
  if (pitch >= line_end) return false;
  char const* const begin = text.data();
  ImageMetadata found;
  std::from_chars(begin + signature.size(), begin + pitch, found.bit_depth);
  std::from_chars(begin + pitch + pitch_label.size(), begin + line_end, found.pixel_pitch_m);
  found.description = line_end < text.size() ? text.substr(line_end + 1) : std::string();
  metadata = found;
  return true;
}

ImageMetadata metadata_of(PageHeader const& header) {
  ImageMetadata metadata;
  if (parse_description(header.description, metadata)) return metadata;
  metadata.description = header.description;
  metadata.bit_depth = header.bits;
  // A resolution without a unit, or in inches as printers' settings, says nothing about a sensor.
  bool const in_centimetres = header.resolution_unit == "cm";
  if (in_centimetres && header.resolution > 0.0f)
    metadata.pixel_pitch_m = 0.01 / static_cast<double>(header.resolution);
  return metadata;
}

/// More values than any compression packs into a byte of a file: 1032 in deflate (a run of 258 bytes takes two bits),
/// 1365 in LZW (twelve bits for 4 kB at the most), more only in what pictures are not written in.
constexpr double most_packed = 2048;
constexpr double always_believed = 16e6;  // bytes: nothing is lost by asking for them
constexpr int most_pages_counted = 1000;

/// A header is believed where the file is long enough for its pixels, and memory for them.
void check_size(PageHeader const& spec, std::string const& path, std::uint64_t file_bytes) {
  double const pixels = static_cast<double>(spec.width) * spec.height * spec.depth;
  double const samples = pixels * spec.channels;
  std::string const sizes = fmt::format("{} x {} px of {} {}", spec.width, spec.height, spec.channels,
                                        spec.channels == 1 ? "value" : "values");
  double const stored = samples * std::max(spec.bits, 1) / 8;
  // without compression, one byte of a palette's indices gives three of colours
  bool const packed = spec.compression != "none";
  double const most = static_cast<double>(file_bytes) * (packed ? most_packed : 4.0);
  if (stored > std::max(most, packed ? always_believed : 0.0) || spec.width <= 0 || spec.height <= 0) {
    // where no entry tells the bits of a sample, TIFF means one, and OpenImageIO reads bytes
    bool const perhaps_bits = spec.bits == 8 && !packed && stored <= 8.0 * static_cast<double>(file_bytes);
    throw DataError(path, fmt::format("is damaged or cut short{}: its header tells of {}, {:.3g} MB, and the file has "
                                      "{:.3g} MB; {}",
                                      perhaps_bits ? ", or has one bit a pixel" : "", sizes, stored / 1e6,
                                      static_cast<double>(file_bytes) / 1e6,
                                      perhaps_bits ? "write it with 8 or 16 bits a pixel" : "copy it again"));
  }
  if (spec.depth > 1) throw DataError(path, fmt::format("is a volume of {} slices; give one picture", spec.depth));
  // the library's tile or strip, the samples as stored and as numbers, and the picture
  double const tile = spec.tile_px[0] * spec.tile_px[1] * std::max(spec.tile_px[2], 1.0);
  double const tile_bytes = tile * spec.channels * static_cast<double>(spec.sample_bytes);
  double const sample_bytes = static_cast<double>(spec.sample_bytes) + sizeof(double);
  require_memory(path, "a picture of " + sizes, tile_bytes + samples * sample_bytes + pixels * sizeof(double));
}

/// All samples as stored. OpenImageIO widens 10, 12 and other odd depths to 8 or 16 bits by scaling; `shift` undoes it.
template <class Stored>
std::vector<double> read_samples(PageReader& input, std::string const& path, int shift) {
  PageHeader const spec = input.header();
  std::vector<Stored> samples(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                              static_cast<std::size_t>(spec.channels));
  if (!input.read(samples.data()))
    throw DataError(path, "cannot be read to its end (it is damaged or cut short); copy it again");
  throw_if_interrupted();
  std::vector<double> values(samples.size());
  double const scale = shift > 0 ? 1.0 / static_cast<double>(1 << shift) : 1.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    values[i] = shift > 0 ? std::floor(static_cast<double>(samples[i]) * scale) : static_cast<double>(samples[i]);
  }
  return values;
}

std::vector<double> read_samples(PageReader& input, std::string const& path) {
  PageHeader const spec = input.header();
  int const held = static_cast<int>(8 * spec.sample_bytes);
  int const shift = spec.bits > 0 && spec.bits < held ? held - spec.bits : 0;
  switch (spec.type) {
    case SampleType::uint8:
      return read_samples<std::uint8_t>(input, path, shift);
    case SampleType::uint16:
      return read_samples<std::uint16_t>(input, path, shift);
    case SampleType::int16:
      return read_samples<std::int16_t>(input, path, 0);
    case SampleType::uint32:
      return read_samples<std::uint32_t>(input, path, 0);
    case SampleType::int32:
      return read_samples<std::int32_t>(input, path, 0);
    case SampleType::float32:
      return read_samples<float>(input, path, 0);
    case SampleType::float64:
      return read_samples<double>(input, path, 0);
    case SampleType::other:
      break;
  }
  throw DataError(path, "has samples of type " + spec.type_name + ", which is not read");
}

/// A picture file, open at its first page.
class Picture {
 public:
  explicit Picture(std::string const& path) : path_(path), file_(path, "a picture") {
    input_ = image_codecs().open(path);
    if (!input_) {
      throw DataError(path,
                      "cannot be read as a picture (it is of another format, damaged or cut short); give TIFF, "
                      "PNG or EXR, if need be written anew without compression");
    }
    count_pages();
  }

  /// Without the smaller ones that are previews of the first.
  std::size_t pages() const { return pages_.size(); }

  Image<double> read(std::size_t page, ImageMetadata* metadata) {
    if (!input_->seek(pages_[page])) {
      throw DataError(path_, fmt::format("page {} cannot be read (the file is damaged); copy it again", page + 1));
    }
    PageHeader const spec = input_->header();
    check_size(spec, path_, file_.size());
    auto const samples = read_samples(*input_, path_);
    std::size_t const channels = static_cast<std::size_t>(spec.channels);
    Image<double> image(spec.width, spec.height);
    for (std::size_t i = 0; i < image.size(); ++i) {
      double const* const sample = samples.data() + i * channels;
      image.data()[i] = channels < 3 ? sample[0] : 0.2126 * sample[0] + 0.7152 * sample[1] + 0.0722 * sample[2];
    }
    if (metadata) {
      *metadata = metadata_of(spec);
      metadata->channels = spec.channels;
      metadata->sample_bits = spec.bits;
    }
    return image;
  }

 private:
  void count_pages() {
    PageHeader const first = input_->header();
    for (int page = 1; page < most_pages_counted && input_->seek(page); ++page) {
      throw_if_interrupted();
      PageHeader const spec = input_->header();
      if (spec.width < first.width && spec.height < first.height) continue;
      pages_.push_back(page);
    }
    input_->clear_errors();
    input_->seek(0);
  }

  std::string path_;
  InputFile file_;
  std::unique_ptr<PageReader> input_;
  std::vector<int> pages_{0};
};

/// What goes wrong for want of memory names the file.
template <class Read>
auto named(std::string const& path, Read const& read) {
  try {
    return read();
  } catch (std::bad_alloc const&) {
    throw MemoryError(path, "does not fit into memory; give a smaller picture, or use a machine with more");
  } catch (std::length_error const&) {
    throw MemoryError(path, "does not fit into memory; give a smaller picture, or use a machine with more");
  }
}

}  // namespace

Image<double> read_image(std::string const& path, ImageMetadata* metadata) {
  return named(path, [&] {
    Picture picture(path);
    if (picture.pages() > 1) {
      throw DataError(path, fmt::format("has {} pages, and one picture is needed; write the page that is meant to a "
                                        "file of its own (a file of two frames, reference and flow, is given alone: "
                                        "gladstone correlate PAIR.tif -o vectors.csv)",
                                        picture.pages()));
    }
    return picture.read(0, metadata);
  });
}

std::array<Image<double>, 2> read_frame_pair(std::string const& path, ImageMetadata* metadata) {
  return named(path, [&] {
    Picture picture(path);
    if (picture.pages() != 2) {
      throw DataError(path, fmt::format("has {} {}, and a file that is given alone needs two: reference and flow; give "
                                        "two pictures, or a case folder",
                                        picture.pages(), picture.pages() == 1 ? "page" : "pages"));
    }
    Image<double> reference = picture.read(0, metadata);
    return std::array{std::move(reference), picture.read(1, nullptr)};
  });
}

std::size_t count_not_finite(Image<double> const& image) {
  return static_cast<std::size_t>(
      std::count_if(image.begin(), image.end(), [](double value) { return !std::isfinite(value); }));
}

void write_tiff(std::string const& path, Image<std::uint16_t> const& image, ImageMetadata const& metadata) {
  auto const fail = [&](std::string const& why) {
    throw OutputError(path, "the image cannot be written (" + why + ')');
  };
  GreyPage page{image.columns(), image.rows(), image.data(), described(metadata), "gladstone " + std::string(version)};
  if (metadata.pixel_pitch_m > 0.0) page.pixels_per_centimetre = 0.01 / metadata.pixel_pitch_m;

  // Into memory first: libtiff does not say when a disk is full.
  std::vector<unsigned char> bytes;
  if (std::string const why = image_codecs().encode_tiff(path, page, bytes); !why.empty()) fail(why);

  OutputFile file(path);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

std::string encode_png(Image<std::uint8_t> const& image) {
  std::vector<unsigned char> bytes;
  std::string const why = image_codecs().encode_png(image.columns(), image.rows(), image.data(), bytes);
  if (!why.empty()) throw DataError("a picture in memory", "cannot be encoded as PNG: " + why);
  return {bytes.begin(), bytes.end()};
}

}  // namespace gladstone
