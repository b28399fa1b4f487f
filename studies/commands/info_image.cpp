#include "studies/commands/info_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "render/base/error.h"
#include "studies/case/image_statistics.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"

namespace gladstone::inline commands {
namespace {

/// Returns the number of lowest bits that are zero in all pixels. Cameras of 12 bits store their grey levels in 16 bits
/// either as they are, which gives 0, or multiplied by 16, which gives 4.
int count_unused_bits(Image<double> const& image) {
  constexpr double largest = 65535;
  std::uint32_t used = 0;
  for (double const value : image) {
    if (!(value >= 0 && value <= largest) || value != std::floor(value)) return 0;
    used |= static_cast<std::uint32_t>(value);
  }
  return used == 0 ? 0 : std::countr_zero(used);
}

/// Range of the grey levels of an image.
struct GreyLevels {
  double least, most;      ///< extremes of the finite pixels
  std::size_t not_finite;  ///< number of pixels that are NaN or infinite
};

/// @param name  name of the image in messages
/// @throws DataError if no pixel is finite
GreyLevels find_grey_levels(std::string const& name, Image<double> const& image) {
  std::size_t const not_finite = count_not_finite(image);
  if (not_finite == image.size()) {
    throw DataError(ErrorCode::invalid_value, name,
                    fmt::format("all of its {} pixels are nan or infinite; export it again", not_finite));
  }
  if (not_finite > 0) {
    log_warning({WarningCode::excluded, name,
                 fmt::format("{} of {} pixels are nan or infinite, and are excluded", not_finite, image.size())});
  }
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (double const value : image) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  return {.least = least, .most = most, .not_finite = not_finite};
}

std::vector<ResultRow> image_rows(Image<double> const& image, ImageMetadata const& metadata, GreyLevels const& levels) {
  std::vector<ResultRow> rows;
  auto const add = [&rows](char const* key, char const* label, double value, char const* unit = "",
                           std::string note = "") -> ResultRow& {
    return rows.emplace_back(
        ResultRow{.key = key, .label = label, .value = value, .unit = unit, .note = std::move(note)});
  };
  auto const add_count = [&add](char const* key, char const* label, auto count, char const* unit = "",
                                std::string note = "") {
    add(key, label, static_cast<double>(count), unit, std::move(note)).whole = true;
  };
  int const unused_bits = count_unused_bits(image);
  ImageStatistics const seen = image_statistics(image);
  char const* const undetected = std::isfinite(seen.snr()) ? "" : "no noise or no dots detected";
  add_count("columns", "columns", image.columns(), "px");
  add_count("rows", "rows", image.rows(), "px");
  add_count("bit_depth", "bits per pixel", metadata.bit_depth);
  add_count("unused_bits", "lowest bits that are 0 in all pixels", unused_bits, "",
            unused_bits > 0 ? fmt::format("all levels are multiples of {}", 1 << unused_bits) : "");
  add_count("channels", "channels", metadata.channels, "",
            metadata.channels >= 3 ? "colour converted to luminance" : "");
  add_count("orientation", "Orientation", metadata.orientation, "", metadata.orientation == 1 ? "" : "rotated upright");
  add("pixel_pitch_um", "pixel pitch", metadata.pixel_pitch_m * 1e6, "um",
      metadata.pixel_pitch_m > 0 ? "" : "not stated in the file");
  add("minimum", "smallest grey level", levels.least);
  add("maximum", "largest grey level", levels.most);
  add("mean", "mean grey level", seen.mean);
  add_count("not_finite", "pixels without a finite value", levels.not_finite);
  add("dot_diameter_px", "diameter of the dots (e^-2)", seen.dot_diameter_px, "px");
  add("background", "level of the background", seen.background);
  add("dot_height", "height of the dots above the background", seen.dot_height);
  add("noise", "standard deviation of the noise", seen.noise);
  add("snr", "signal-to-noise ratio", seen.snr(), "", undetected).symbol = "SNR";
  return rows;
}

}  // namespace

Description describe_image(std::string const& path) {
  ImageMetadata metadata;
  Image<double> const image = read_image(path, &metadata);
  return describe_image(path, image, metadata);
}

Description describe_image(std::string const& name, Image<double> const& image, ImageMetadata const& metadata) {
  std::vector<ResultRow> rows = image_rows(image, metadata, find_grey_levels(name, image));
  return {json_text(nlohmann::json(rows_json(rows))), name + '\n' + rows_text(rows), std::move(rows)};
}

}  // namespace gladstone::inline commands
