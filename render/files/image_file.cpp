#include "render/files/image_file.h"

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
#include "render/base/interrupt.h"
#include "render/base/version.h"
#include "render/files/image_codecs.h"
#include "render/files/image_pages.h"
#include "render/files/input_file.h"
#include "render/files/output_file.h"
#include "render/files/tiff_file.h"

namespace gladstone {
namespace {

/// First line of the ImageDescription written by gladstone, "# gladstone image, bit_depth = 12, pixel_pitch_m = 1e-05".
/// It is a TOML comment, so that a setup below it remains valid TOML.
constexpr std::string_view signature = "# gladstone image, bit_depth = ";
constexpr std::string_view pitch_label = ", pixel_pitch_m = ";

std::string described(ImageMetadata const& metadata) {
  return std::string(signature) + std::to_string(metadata.bit_depth) + std::string(pitch_label) +
         fmt::format("{:.15g}", metadata.pixel_pitch_m) + '\n' +
         metadata.description;  // 15 digits, so that 10 um is written as 1e-05, not as 9.99..e-06
}

/// Parses the metadata of an ImageDescription; false if it was not written by gladstone.
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
  metadata = std::move(found);
  return true;
}

ImageMetadata metadata_of(PageHeader const& header) {
  ImageMetadata metadata;
  if (parse_description(header.description, metadata)) return metadata;
  metadata.description = header.description;
  metadata.bit_depth = header.bits;
  // A resolution without a unit, or in inches (a printer setting), does not describe the sensor.
  bool const in_centimetres = header.resolution_unit == "cm";
  if (in_centimetres && header.resolution > 0.0f)
    metadata.pixel_pitch_m = 0.01 / static_cast<double>(header.resolution);
  return metadata;
}

/// Upper limit on the compression ratio of an image: above 1032 for deflate (2 bits for a run of 258 bytes) and 1365
/// for LZW (12 bits for at most 4 kB). Higher ratios only occur in formats that are not used for images.
constexpr double most_packed = 2048;
/// Decoded size of a compressed image, or of a tile, up to which the header is trusted [bytes].
constexpr double believed_image_bytes = 16e6;

/// Throws unless the file is long enough for the pixels and tiles that its header declares, and memory is available for
/// them.
void check_size(PageHeader const& spec, std::string const& path, std::uint64_t file_bytes) {
  double const pixels = static_cast<double>(spec.width) * spec.height * spec.depth;
  double const samples = pixels * spec.channels;
  std::string const sizes = fmt::format("{} x {} px of {} {}", spec.width, spec.height, spec.channels,
                                        spec.channels == 1 ? "value" : "values");
  double const stored = pixels * spec.pixel_bits / 8;
  bool const packed = spec.compression != "none";
  double const most = static_cast<double>(file_bytes) * (packed ? most_packed : 1.0);
  if (stored > std::max(most, packed ? believed_image_bytes : 0.0) || spec.width <= 0 || spec.height <= 0) {
    throw DataError(
        path,
        fmt::format(
            "is damaged or cut short: its header declares {}, {:.3g} MB, but the file has {:.3g} MB; copy it again",
            sizes, stored / 1e6, static_cast<double>(file_bytes) / 1e6));
  }
  if (spec.depth > 1) throw DataError(path, fmt::format("is a volume of {} slices; give a single image", spec.depth));
  double const tile = spec.tile_px[0] * spec.tile_px[1] * std::max(spec.tile_px[2], 1.0);
  if (tile * spec.pixel_bits / 8 > std::max(most, believed_image_bytes)) {
    throw DataError(path, fmt::format("is damaged or cut short: its header declares tiles of {:.0f} x {:.0f} px, but "
                                      "the file has {:.3g} MB; copy it again",
                                      spec.tile_px[0], spec.tile_px[1], static_cast<double>(file_bytes) / 1e6));
  }
  // Memory: tile or strip of the codec library, samples as stored, samples as double, and the image.
  double const tile_bytes = tile * spec.channels * static_cast<double>(spec.sample_bytes);
  double const sample_bytes = static_cast<double>(spec.sample_bytes) + sizeof(double);
  require_memory(path, "an image of " + sizes, tile_bytes + samples * sample_bytes + pixels * sizeof(double));
}

constexpr std::size_t ink_count = 4;

/// Weights of red, green and blue in the luminance (Rec. ITU-R BT.709, section 3.2).
constexpr std::array<double, 3> luminance_weights{0.2126, 0.7152, 0.0722};

/// Throws DataError if the channels are neither grey levels nor colours.
void check_channels(PageHeader const& spec, std::string const& path) {
  if (spec.colours == Colours::grey && spec.channels > 2) {
    throw DataError(path, fmt::format("has {} values per pixel that are not colours (its header declares them as "
                                      "grey); write the intended channel to a separate file",
                                      spec.channels));
  }
  if (spec.colours == Colours::inks && static_cast<std::size_t>(spec.channels) != ink_count) {
    throw DataError(path, fmt::format("has {} printing inks, but only cyan, magenta, yellow and black are supported; "
                                      "write it as grey levels or RGB",
                                      spec.channels));
  }
}

/// Returns the largest possible stored value of a sample; 1 for floating-point samples.
double full_scale(PageHeader const& spec) {
  bool const floating = spec.type == SampleType::float32 || spec.type == SampleType::float64;
  return floating ? 1.0 : std::pow(2.0, spec.bits) - 1;
}

/// Computes the grey level of a pixel.
double grey_level(PageHeader const& spec, double const* sample) {
  double level = 0;
  if (spec.colours == Colours::inks) {  // transmittance of the complementary ink times that of black
    double const full = full_scale(spec), black = sample[ink_count - 1];
    for (std::size_t i = 0; i < luminance_weights.size(); ++i) {
      level += luminance_weights[i] * (full - sample[i]) * (full - black) / full;
    }
    return level;
  }
  if (spec.channels < 3) return sample[0];
  for (std::size_t i = 0; i < luminance_weights.size(); ++i) level += luminance_weights[i] * sample[i];
  return level;
}

/// Reads the grey levels of a page, in its orientation. Readers scale 10, 12 and other bit depths up to 8 or 16 bits;
/// `shift` [bits] undoes this.
template <class Stored>
Image<double> read_levels(PageReader& input, PageHeader const& spec, std::string const& path, int shift) {
  auto const channels = static_cast<std::size_t>(spec.channels);
  Image<double> image(spec.width, spec.height);
  auto const samples = std::make_unique_for_overwrite<Stored[]>(image.size() * channels);
  if (std::string const why = input.read(samples.get()); !why.empty()) {
    throw DataError(path, fmt::format("cannot be read to its end (it is damaged, cut short or compressed by an unknown "
                                      "method: {}); copy it again, or write it anew without compression",
                                      why));
  }
  throw_if_interrupted();
  double const scale = shift > 0 ? 1.0 / static_cast<double>(1 << shift) : 1.0;
  auto const value_of = [&](Stored sample) {
    return shift > 0 ? std::floor(static_cast<double>(sample) * scale) : static_cast<double>(sample);
  };
  if (channels == 1) {
    std::transform(samples.get(), samples.get() + image.size(), image.data(), value_of);
    return image;
  }
  std::vector<double> pixel(channels);
  for (std::size_t i = 0; i < image.size(); ++i) {
    std::transform(samples.get() + i * channels, samples.get() + (i + 1) * channels, pixel.begin(), value_of);
    image.data()[i] = grey_level(spec, pixel.data());
  }
  return image;
}

Image<double> read_levels(PageReader& input, std::string const& path) {
  PageHeader const spec = input.header();
  int const held = static_cast<int>(8 * spec.sample_bytes);
  int const shift = spec.bits > 0 && spec.bits < held ? held - spec.bits : 0;
  switch (spec.type) {
    case SampleType::uint8:
      return read_levels<std::uint8_t>(input, spec, path, shift);
    case SampleType::uint16:
      return read_levels<std::uint16_t>(input, spec, path, shift);
    case SampleType::int16:
      return read_levels<std::int16_t>(input, spec, path, 0);
    case SampleType::uint32:
      return read_levels<std::uint32_t>(input, spec, path, 0);
    case SampleType::int32:
      return read_levels<std::int32_t>(input, spec, path, 0);
    case SampleType::float32:
      return read_levels<float>(input, spec, path, 0);
    case SampleType::float64:
      return read_levels<double>(input, spec, path, 0);
    case SampleType::other:
      break;
  }
  throw DataError(path, "has samples of type " + spec.type_name +
                            ", which is not supported; write it with unsigned integers of 8 or 16 bits, or floats");
}

/// Corrects the orientation of an image. TIFF 6.0, section 8: stored row 0 is the visual top (1, 2), bottom (3, 4),
/// left (5, 8) or right side (6, 7); stored column 0 is the left (1, 4), right (2, 3), top (5, 6) or bottom side (7,
/// 8).
Image<double> turn_upright(Image<double> stored, int orientation) {
  if (orientation <= 1 || orientation > 8) return stored;
  bool const transposed = orientation >= 5;
  bool const from_right = orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
  bool const from_bottom = orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
  int const columns = transposed ? stored.rows() : stored.columns();
  int const rows = transposed ? stored.columns() : stored.rows();
  Image<double> upright(columns, rows);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      int const x = from_right ? columns - 1 - column : column, y = from_bottom ? rows - 1 - row : row;
      upright(column, row) = transposed ? stored(y, x) : stored(x, y);
    }
  }
  return upright;
}

/// Image file opened for reading.
class Picture {
 public:
  explicit Picture(std::string const& path) : path_(path), file_(path, "an image"), input_(open_tiff(file_)) {
    if (!input_) input_ = image_codecs().open(path);
    if (!input_) {
      std::string const samples = describe_tiff_samples(file_);
      throw DataError(path,
                      "cannot be read as an image (it is of another format, " +
                          (samples.empty() ? "" : "a TIFF with " + samples + ", ") +
                          "damaged or cut short); give TIFF, PNG, JPEG or EXR, if necessary written again without "
                          "compression");
    }
    count_pages();
  }

  /// Number of pages, without the previews of the first one, which are smaller in both directions.
  std::size_t pages() const { return pages_.size(); }
  /// True if the file has more than max_pages pages.
  bool has_more_pages() const { return has_more_pages_; }

  Image<double> read(std::size_t page, ImageMetadata* metadata) {
    if (!input_->seek(pages_[page])) {
      throw DataError(path_, fmt::format("page {} cannot be read (the file is damaged); copy it again", page + 1));
    }
    PageHeader const spec = input_->header();
    check_size(spec, path_, file_.size());
    check_channels(spec, path_);
    Image<double> image = turn_upright(read_levels(*input_, path_), spec.orientation);
    if (metadata) {
      *metadata = metadata_of(spec);
      metadata->channels = spec.colours == Colours::inks ? spec.channels - 1 : spec.channels;
      metadata->sample_bits = spec.bits;
      metadata->orientation = spec.orientation;
    }
    return image;
  }

 private:
  /// Collects the pages that are not previews of the first one, up to max_pages.
  void count_pages() {
    PageHeader const first = input_->header();
    for (int page = 1; input_->seek(page); ++page) {
      throw_if_interrupted();
      if (page == max_pages) {
        has_more_pages_ = true;
        break;
      }
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
  bool has_more_pages_ = false;
};

/// Calls `read`, and converts a failed allocation into a MemoryError that names the file.
template <class Read>
auto named(std::string const& path, Read const& read) {
  try {
    return read();
  } catch (std::bad_alloc const&) {
    throw MemoryError(path, "does not fit into memory; give a smaller image, or use a machine with more");
  } catch (std::length_error const&) {
    throw MemoryError(path, "does not fit into memory; give a smaller image, or use a machine with more");
  }
}

}  // namespace

Image<double> read_image(std::string const& path, ImageMetadata* metadata) {
  return named(path, [&] {
    Picture picture(path);
    if (picture.pages() > 1) {
      throw DataError(
          path,
          fmt::format(
              "has {} pages, but a single image is needed; write the intended page to a separate file (a file of two "
              "frames, reference and flow, is passed as the only input: gladstone correlate PAIR.tif -o vectors.csv)",
              picture.pages()));
    }
    return picture.read(0, metadata);
  });
}

std::array<Image<double>, 2> read_frame_pair(std::string const& path, ImageMetadata* metadata) {
  return named(path, [&] {
    Picture picture(path);
    if (picture.pages() != 2) {
      throw DataError(
          path,
          fmt::format(
              "has {} {}, but a single input file needs two: reference and flow; give two images, or a case folder",
              picture.pages(), picture.pages() == 1 ? "page" : "pages"));
    }
    Image<double> reference = picture.read(0, metadata);
    return std::array{std::move(reference), picture.read(1, nullptr)};
  });
}

std::size_t count_pages(std::string const& path) {
  return named(path, [&] {
    Picture const picture(path);
    if (picture.has_more_pages()) {
      throw DataError(path, fmt::format("has more than {} pages (which is the limit); write its pages to several files",
                                        max_pages));
    }
    return picture.pages();
  });
}

Image<double> read_page(std::string const& path, std::size_t page, ImageMetadata* metadata) {
  return named(path, [&] {
    Picture picture(path);
    if (page >= picture.pages()) {
      throw DataError(path, fmt::format("has {} {}, and no page {}; copy it again", picture.pages(),
                                        picture.pages() == 1 ? "page" : "pages", page + 1));
    }
    return picture.read(page, metadata);
  });
}

std::size_t count_not_finite(Image<double> const& image) {
  return static_cast<std::size_t>(
      std::count_if(image.begin(), image.end(), [](double value) { return !std::isfinite(value); }));
}

void write_tiff(std::string const& path, Image<std::uint16_t> const& image, ImageMetadata const& metadata) {
  GreyPage page{image.columns(), image.rows(), image.data(), described(metadata), "gladstone " + std::string(version)};
  if (metadata.pixel_pitch_m > 0.0) page.pixels_per_centimetre = 0.01 / metadata.pixel_pitch_m;

  // Encode in memory first, since libtiff does not report a full disk.
  std::vector<unsigned char> const bytes = named(path, [&] { return encode_tiff(path, page); });
  OutputFile file(path);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

std::string encode_png(Image<std::uint8_t> const& image) {
  std::vector<unsigned char> bytes;
  std::string const why = image_codecs().encode_png(image.columns(), image.rows(), image.data(), bytes);
  if (!why.empty()) throw DataError("an image in memory", "cannot be encoded as PNG: " + why);
  return {bytes.begin(), bytes.end()};
}

}  // namespace gladstone
