#include "studies/compare/stereo_alignment.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "render/base/error.h"
#include "render/base/units.h"

namespace gladstone::inline compare {
namespace {

/// Settings for disparities: large windows, since the images of a thick sheet agree only on average.
CorrelationSettings choose_disparity_settings(stereo::SimultaneousImages const& images) {
  constexpr int largest = 128, last = 64;  // [px]
  int side = largest;
  for (Image<double> const& image : images) side = std::min({side, image.columns() / 2, image.rows() / 2});
  side = std::max(4, side - side % 2);
  CorrelationSettings settings;
  settings.window_px = {side, std::min(side, last), std::min(side, last)};
  settings.overlap = 0.5;
  return settings;
}

}  // namespace

std::vector<stereo::SimultaneousImages> read_simultaneous_images(std::vector<std::string> const& files,
                                                                 SourceFiles& sources) {
  std::vector<stereo::SimultaneousImages> images;
  for (std::size_t i = 0; i + 1 < files.size(); i += 2) {
    stereo::SimultaneousImages both;
    for (std::size_t camera = 0; camera < 2; ++camera) {
      std::string const& file = files[i + camera];
      both[camera] = sources.add_image("", file);
      if (images.empty()) continue;
      Image<double> const& first = images.front()[camera];
      if (first.columns() == both[camera].columns() && first.rows() == both[camera].rows()) continue;
      throw DataError(
          ErrorCode::wrong_shape, file,
          fmt::format("is {} x {} px, but {} is {} x {}; give the images of the first and of the "
                      "second camera in turn",
                      both[camera].columns(), both[camera].rows(), files[camera], first.columns(), first.rows()));
    }
    images.push_back(std::move(both));
  }
  return images;
}

stereo::SheetAlignment align_sheet_of_images(std::vector<stereo::SimultaneousImages> const& images,
                                             std::array<PinholeCamera const*, 2> const& cameras,
                                             stereo::ObjectPlane const& plane) {
  stereo::SheetAlignment alignment =
      stereo::align_sheet(cameras, images, plane, choose_disparity_settings(images.front()));
  stereo::ObjectPlane const& found = alignment.fit.plane;
  spdlog::info(
      "laser sheet: Z = {:.4f} mm + {:.5f} X + {:.5f} Y; disparity {:.3f} px with a standard uncertainty of {:.3f} px, "
      "residual {:.3f} px after {} iterations",
      found.height / unit::mm, found.slope.x, found.slope.y, alignment.disparity_px.front(),
      alignment.disparity_sigma_px, alignment.disparity_px.back(), alignment.disparity_px.size());
  return alignment;
}

std::optional<stereo::SheetAlignment> measure_disparity(std::vector<stereo::SimultaneousImages> const& images,
                                                        std::array<PinholeCamera const*, 2> const& cameras,
                                                        stereo::ObjectPlane const& plane) {
  try {
    return stereo::align_sheet(cameras, images, plane, choose_disparity_settings(images.front()), 1);
  } catch (DataError const& error) {
    spdlog::info("the disparity between the cameras is unknown: {}", error.what());
    return std::nullopt;
  }
}

}  // namespace gladstone::inline compare
