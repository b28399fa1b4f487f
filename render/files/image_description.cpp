#include "render/files/image_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

namespace gladstone::inline files {
namespace {

/// First line of the ImageDescription written by gladstone, "# gladstone image, bit_depth = 12, pixel_pitch_m = 1e-05".
/// It is a TOML comment, so that a setup below it remains valid TOML.
constexpr std::string_view signature = "# gladstone image, bit_depth = ";
constexpr std::string_view pitch_label = ", pixel_pitch_m = ";

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

}  // namespace

std::string image_description(ImageMetadata const& metadata) {
  return std::string(signature) + std::to_string(metadata.bit_depth) + std::string(pitch_label) +
         fmt::format("{:.15g}", metadata.pixel_pitch_m) + '\n' +
         metadata.description;  // 15 digits, so that 10 um is written as 1e-05, not as 9.99..e-06
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

}  // namespace gladstone::inline files
