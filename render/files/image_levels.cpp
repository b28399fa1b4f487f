#include "render/files/image_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"

namespace gladstone::inline files {
namespace {

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
        ErrorCode::damaged, path,
        fmt::format(
            "is damaged or cut short: its header declares {}, {:.3g} MB, but the file has {:.3g} MB; copy it again",
            sizes, stored / 1e6, static_cast<double>(file_bytes) / 1e6));
  }
  if (spec.depth > 1)
    throw DataError(ErrorCode::wrong_shape, path,
                    fmt::format("is a volume of {} slices; give a single image", spec.depth));
  double const tile = spec.tile_px[0] * spec.tile_px[1] * std::max(spec.tile_px[2], 1.0);
  if (tile * spec.pixel_bits / 8 > std::max(most, believed_image_bytes)) {
    throw DataError(ErrorCode::damaged, path,
                    fmt::format("is damaged or cut short: its header declares tiles of {:.0f} x {:.0f} px, but "
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
    throw DataError(ErrorCode::unsupported, path,
                    fmt::format("has {} values per pixel that are not colours (its header declares them as "
                                "grey); write the intended channel to a separate file",
                                spec.channels));
  }
  if (spec.colours == Colours::inks && static_cast<std::size_t>(spec.channels) != ink_count) {
    throw DataError(ErrorCode::unsupported, path,
                    fmt::format("has {} printing inks, but only cyan, magenta, yellow and black are supported; "
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

/// Reads all samples of a page, in its orientation.
template <class Stored>
std::unique_ptr<Stored[]> read_samples(PageReader& input, PageHeader const& spec, std::string const& path) {
  std::size_t const count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                            static_cast<std::size_t>(spec.channels);
  auto samples = std::make_unique_for_overwrite<Stored[]>(count);
  if (std::string const why = input.read(samples.get()); !why.empty()) {
    throw DataError(ErrorCode::damaged, path,
                    fmt::format("cannot be read to its end (it is damaged, cut short or compressed by an unknown "
                                "method: {}); copy it again, or write it anew without compression",
                                why));
  }
  throw_if_interrupted();
  return samples;
}

/// Returns the number of bits by which the reader has shifted the samples: it scales 10, 12 and other bit depths up to
/// 8 or 16 bits.
int scaled_bits(PageHeader const& spec) {
  int const held = static_cast<int>(8 * spec.sample_bytes);
  return spec.bits > 0 && spec.bits < held ? held - spec.bits : 0;
}

/// Reads a page of one unsigned integer per pixel.
template <class Stored>
Image<std::uint16_t> read_integers(PageReader& input, PageHeader const& spec, std::string const& path) {
  int const shift = scaled_bits(spec);
  Image<std::uint16_t> image(spec.width, spec.height);
  auto const samples = read_samples<Stored>(input, spec, path);
  std::transform(samples.get(), samples.get() + image.size(), image.data(),
                 [shift](Stored sample) { return static_cast<std::uint16_t>(sample >> shift); });
  return image;
}

/// Reads the grey levels of a page, in its orientation.
/// @param shift  see scaled_bits()
template <class Stored>
Image<double> read_levels(PageReader& input, PageHeader const& spec, std::string const& path, int shift) {
  auto const channels = static_cast<std::size_t>(spec.channels);
  Image<double> image(spec.width, spec.height);
  auto const samples = read_samples<Stored>(input, spec, path);
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
  int const shift = scaled_bits(spec);
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
  throw DataError(ErrorCode::unsupported, path,
                  "has samples of type " + spec.type_name +
                      ", which is not supported; write it with unsigned integers of 8 or 16 bits, or floats");
}

/// Corrects the orientation of an image. TIFF 6.0, section 8: stored row 0 is the visual top (1, 2), bottom (3, 4),
/// left (5, 8) or right side (6, 7); stored column 0 is the left (1, 4), right (2, 3), top (5, 6) or bottom side (7,
/// 8).
template <class Pixel>
Image<Pixel> turn_upright(Image<Pixel> stored, int orientation) {
  if (orientation <= 1 || orientation > 8) return stored;
  bool const transposed = orientation >= 5;
  bool const from_right = orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
  bool const from_bottom = orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
  int const columns = transposed ? stored.rows() : stored.columns();
  int const rows = transposed ? stored.columns() : stored.rows();
  Image<Pixel> upright(columns, rows);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      int const x = from_right ? columns - 1 - column : column, y = from_bottom ? rows - 1 - row : row;
      upright(column, row) = transposed ? stored(y, x) : stored(x, y);
    }
  }
  return upright;
}

}  // namespace

Image<double> read_grey_levels(PageReader& input, std::string const& path, std::uint64_t file_bytes) {
  PageHeader const spec = input.header();
  check_size(spec, path, file_bytes);
  check_channels(spec, path);
  return turn_upright(read_levels(input, path), spec.orientation);
}

StoredLevels read_stored_levels(PageReader& input, std::string const& path, std::uint64_t file_bytes) {
  PageHeader const spec = input.header();
  bool const of_bytes = spec.type == SampleType::uint8;
  if (spec.channels != 1 || !(of_bytes || spec.type == SampleType::uint16)) {
    return read_grey_levels(input, path, file_bytes);
  }
  check_size(spec, path, file_bytes);
  return turn_upright(
      of_bytes ? read_integers<std::uint8_t>(input, spec, path) : read_integers<std::uint16_t>(input, spec, path),
      spec.orientation);
}

}  // namespace gladstone::inline files
