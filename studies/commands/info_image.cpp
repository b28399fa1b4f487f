#include "studies/commands/info_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

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

}  // namespace

Description describe_image(std::string const& path) {
  ImageMetadata metadata;
  Image<double> const image = read_image(path, &metadata);
  return describe_image(path, image, metadata);
}

Description describe_image(std::string const& name, Image<double> const& image, ImageMetadata const& metadata) {
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
  int const unused_bits = count_unused_bits(image);
  ImageStatistics const seen = image_statistics(image);
  nlohmann::json const json{{"columns", image.columns()},
                            {"rows", image.rows()},
                            {"bit_depth", metadata.bit_depth},
                            {"unused_bits", unused_bits},
                            {"pixel_pitch_um", metadata.pixel_pitch_m * 1e6},
                            {"minimum", least},
                            {"maximum", most},
                            {"mean", seen.mean},
                            {"not_finite", not_finite},
                            {"dot_diameter_px", number_or_null(seen.dot_diameter_px)},
                            {"channels", metadata.channels},
                            {"orientation", metadata.orientation},
                            {"background", number_or_null(seen.background)},
                            {"dot_height", number_or_null(seen.dot_height)},
                            {"noise", number_or_null(seen.noise)},
                            {"snr", number_or_null(seen.snr())}};
  return {json_text(json),
          fmt::format(
              "{}: {} x {} px, {} bits{}{}{}, grey levels {:.6g} to {:.6g}, mean {:.6g}, {}, {}", name, image.columns(),
              image.rows(), metadata.bit_depth,
              unused_bits > 0 ? fmt::format(" (all levels are multiples of {})", 1 << unused_bits) : "",
              metadata.channels >= 3 ? ", colour converted to luminance" : "",
              metadata.orientation == 1 ? "" : fmt::format(", Orientation {} rotated upright", metadata.orientation),
              least, most, seen.mean,
              std::isfinite(seen.dot_diameter_px) ? fmt::format("dots {:.2f} px (e^-2)", seen.dot_diameter_px)
                                                  : "dots of unknown diameter",
              std::isfinite(seen.snr()) ? fmt::format("SNR {:.3g} (dots {:.4g} levels high, noise {:.3g})", seen.snr(),
                                                      seen.dot_height, seen.noise)
                                        : "SNR unknown (no noise or no dots detected)")};
}

}  // namespace gladstone::inline commands
