#include "studies/compare/stereo_alignment.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/image_file.h"

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

/// Reads images of both cameras. @throws DataError if the images of a camera differ in size
std::vector<stereo::SimultaneousImages> read_simultaneous_images(std::vector<std::string> const& files,
                                                                 SourceFiles& sources) {
  std::vector<stereo::SimultaneousImages> images;
  for (std::size_t i = 0; i + 1 < files.size(); i += 2) {
    stereo::SimultaneousImages both;
    for (std::size_t camera = 0; camera < 2; ++camera) {
      std::string const& file = files[i + camera];
      sources.add("", file, SourceFiles::Holds::pixels);
      both[camera] = read_image(file);
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

}  // namespace

stereo::SheetAlignment align_sheet_of_files(std::vector<std::string> const& images,
                                            std::array<PinholeCamera const*, 2> const& cameras,
                                            stereo::ObjectPlane const& plane, SourceFiles& sources) {
  std::vector<stereo::SimultaneousImages> const read = read_simultaneous_images(images, sources);
  stereo::SheetAlignment alignment = stereo::align_sheet(cameras, read, plane, choose_disparity_settings(read.front()));
  stereo::ObjectPlane const& found = alignment.fit.plane;
  spdlog::info(
      "laser sheet: Z = {:.4f} mm + {:.5f} X + {:.5f} Y; disparity {:.3f} px with a standard uncertainty of {:.3f} px, "
      "residual {:.3f} px after {} iterations",
      found.height / unit::mm, found.slope.x, found.slope.y, alignment.disparity_px.front(),
      alignment.disparity_sigma_px, alignment.disparity_px.back(), alignment.disparity_px.size());
  return alignment;
}

std::optional<stereo::SheetAlignment> measure_disparity(std::vector<std::string> const& images,
                                                        std::array<PinholeCamera const*, 2> const& cameras,
                                                        stereo::ObjectPlane const& plane, SourceFiles& sources) {
  std::vector<stereo::SimultaneousImages> const read = read_simultaneous_images(images, sources);
  try {
    return stereo::align_sheet(cameras, read, plane, choose_disparity_settings(read.front()), 1);
  } catch (DataError const& error) {
    spdlog::info("the disparity between the cameras is unknown: {}", error.what());
    return std::nullopt;
  }
}

}  // namespace gladstone::inline compare
