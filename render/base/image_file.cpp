#include "render/base/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "render/base/error.h"
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

ImageMetadata metadata_of(OIIO::ImageSpec const& spec) {
  ImageMetadata metadata;
  std::string const description = spec.get_string_attribute("ImageDescription");
  if (parse_description(description, metadata)) return metadata;
  metadata.description = description;
  metadata.bit_depth = spec.get_int_attribute("oiio:BitsPerSample", static_cast<int>(8 * spec.format.size()));
  // A resolution without a unit, or in inches as printers' settings, says nothing about a sensor.
  float const resolution = spec.get_float_attribute("XResolution");
  bool const in_centimetres = spec.get_string_attribute("ResolutionUnit") == "cm";
  if (in_centimetres && resolution > 0.0f) metadata.pixel_pitch_m = 0.01 / static_cast<double>(resolution);
  return metadata;
}

/// All samples as stored. OpenImageIO widens 10, 12 and other odd depths to 8 or 16 bits by scaling; `shift` undoes it.
template <class Stored>
std::vector<double> read_samples(OIIO::ImageInput& input, std::string const& path, int shift) {
  OIIO::ImageSpec const& spec = input.spec();
  std::vector<Stored> samples(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
  bool const read = input.read_image(0, 0, 0, spec.nchannels, OIIO::BaseTypeFromC<Stored>::value, samples.data());
  if (!read || input.has_error()) {  // of a TIFF cut short it says true, and leaves an error for every missing strip
    std::string const why = input.geterror();
    throw DataError(path, "cannot be read to its end (" + why.substr(0, why.find('\n')) + "); copy it again");
  }
  std::vector<double> values(samples.size());
  double const scale = shift > 0 ? 1.0 / static_cast<double>(1 << shift) : 1.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    values[i] = shift > 0 ? std::floor(static_cast<double>(samples[i]) * scale) : static_cast<double>(samples[i]);
  }
  return values;
}

std::vector<double> read_samples(OIIO::ImageInput& input, std::string const& path) {
  OIIO::ImageSpec const& spec = input.spec();
  int const held = static_cast<int>(8 * spec.format.size());
  int const bits = spec.get_int_attribute("oiio:BitsPerSample", held);
  int const shift = bits > 0 && bits < held ? held - bits : 0;
  switch (spec.format.basetype) {
    case OIIO::TypeDesc::UINT8:
      return read_samples<std::uint8_t>(input, path, shift);
    case OIIO::TypeDesc::UINT16:
      return read_samples<std::uint16_t>(input, path, shift);
    case OIIO::TypeDesc::INT16:
      return read_samples<std::int16_t>(input, path, 0);
    case OIIO::TypeDesc::UINT32:
      return read_samples<std::uint32_t>(input, path, 0);
    case OIIO::TypeDesc::INT32:
      return read_samples<std::int32_t>(input, path, 0);
    case OIIO::TypeDesc::HALF:
    case OIIO::TypeDesc::FLOAT:
      return read_samples<float>(input, path, 0);
    case OIIO::TypeDesc::DOUBLE:
      return read_samples<double>(input, path, 0);
    default:
      throw DataError(path, std::string("has samples of type ") + spec.format.c_str() + ", which is not read");
  }
}

}  // namespace

Image<double> read_image(std::string const& path, ImageMetadata* metadata) {
  std::error_code error;
  auto const status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw DataError(path, "does not exist; check the name");
  if (std::filesystem::is_directory(status)) throw DataError(path, "is a folder; name a picture");
  OIIO::ImageSpec configuration;
  configuration["oiio:UnassociatedAlpha"] = 1;  // colours as stored, not multiplied by their opacity
  auto const input = OIIO::ImageInput::open(path, &configuration);
  if (!input) throw DataError(path, "cannot be read as a picture (" + OIIO::geterror() + "); give TIFF, PNG or EXR");

  OIIO::ImageSpec const spec = input->spec();
  auto const samples = read_samples(*input, path);
  std::size_t const channels = static_cast<std::size_t>(spec.nchannels);
  Image<double> image(spec.width, spec.height);
  for (std::size_t i = 0; i < image.size(); ++i) {
    double const* const sample = samples.data() + i * channels;
    image.data()[i] = channels < 3 ? sample[0] : 0.2126 * sample[0] + 0.7152 * sample[1] + 0.0722 * sample[2];
  }
  if (metadata) {
    *metadata = metadata_of(spec);
    metadata->channels = spec.nchannels;
    metadata->sample_bits = spec.get_int_attribute("oiio:BitsPerSample", static_cast<int>(8 * spec.format.size()));
  }
  return image;
}

void write_tiff(std::string const& path, Image<std::uint16_t> const& image, ImageMetadata const& metadata) {
  auto const fail = [&](std::string const& why) {
    throw OutputError(path, "the image cannot be written (" + why + ')');
  };
  OIIO::ImageSpec spec(image.columns(), image.rows(), 1, OIIO::TypeDesc::UINT16);
  spec["compression"] = "none";
  spec["ImageDescription"] = described(metadata);
  spec["Software"] = "gladstone " + std::string(version);
  spec["DateTime"] = 0;  // not a text, so that no date is written: equal images are equal files
  if (metadata.pixel_pitch_m > 0.0) {
    float const pixels_per_centimetre = static_cast<float>(0.01 / metadata.pixel_pitch_m);
    spec["XResolution"] = pixels_per_centimetre;
    spec["YResolution"] = pixels_per_centimetre;
    spec["ResolutionUnit"] = "cm";
  }

  // Into memory first: libtiff does not say when a disk is full.
  auto const output = OIIO::ImageOutput::create("tif");
  if (!output) fail(OIIO::geterror());
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  bool const written = output->set_ioproxy(&memory) && output->open(path, spec) &&
                       output->write_image(OIIO::TypeDesc::UINT16, image.data());
  if (!output->close() || !written) fail(output->geterror());

  OutputFile file(path);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

}  // namespace gladstone
