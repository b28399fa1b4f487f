#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/units.h"
#include "render/files/image_file.h"
#include "render/files/output_file.h"
#include "render/files/output_folder.h"
#include "studies/case/case.h"
#include "studies/case/json_text.h"
#include "studies/case/plenoptic_views.h"
#include "studies/case/warning_log.h"

namespace gladstone::inline cases {
namespace {

namespace fs = std::filesystem;

constexpr char const* marker = "views.json";
constexpr double highest_level = 65535;

Image<std::uint16_t> rounded_levels(Image<double> const& levels) {
  Image<std::uint16_t> picture(levels.columns(), levels.rows());
  std::transform(levels.begin(), levels.end(), picture.begin(), [](double level) {
    return static_cast<std::uint16_t>(std::clamp(std::floor(level + 0.5), 0.0, highest_level));
  });
  return picture;
}

/// Returns the index of the view from a position on the stop, along one axis.
int number_of(double place, double diameter, int across) {
  return static_cast<int>(std::lround((place / diameter + 0.5) * across - 0.5));
}

/// Returns the distance from the lens to the plane Z = z along the camera's axis [m].
/// @throws DataError if the lens forms no real image of the plane
double distance_of(Setup const& setup, double z) {
  Pose<double> const pose = setup.camera_pose();
  double const distance = (pose.origin.z - z) / pose.z.z;
  if (distance > setup.lens.focal_length) return distance;
  throw DataError(ErrorCode::out_of_range, "--refocus",
                  fmt::format("Z = {:.6g} mm is less than a focal length in front of the lens, or behind "
                              "it (it has no real image); use a plane farther away",
                              z / unit::millimetre));
}

}  // namespace

ViewsWritten write_views(std::string const& case_folder, std::string const& folder, int across,
                         std::optional<double> refocus_z) {
  std::string const setup_file = in_case(case_folder, case_file::setup);
  CaseSetup loaded = load_case_setup(setup_file, {});
  Setup const& setup = loaded.setup;
  ViewsWritten written;
  written.folder = folder;
  written.camera = PlenopticCamera::of(setup, setup_file);
  std::vector<Vec2d> const stops = stop_positions(written.camera.stop_diameter, across);
  written.views = stops.size();
  double const mm = unit::millimetre, stop = written.camera.stop_diameter;
  nlohmann::ordered_json summary{{"lenslet_pictures_px", written.camera.picture_px()},
                                 {"views", nlohmann::json::array()}};
  std::optional<double> distance;
  if (refocus_z) {
    distance = distance_of(setup, *refocus_z);
    summary["refocused_z_mm"] = *refocus_z / mm;
    summary["parallax_px_per_mm"] = written.camera.parallax(*distance) * mm;
  }
  auto const name_of = [&](Vec2d place) {
    return fmt::format("view_{:02}_{:02}.tif", number_of(-place.y, stop, across), number_of(place.x, stop, across));
  };
  for (Vec2d const place : stops) {
    summary["views"].push_back({{"file", name_of(place)}, {"stop_mm", {place.x / mm, place.y / mm}}});
  }
  // The image of the stop behind a lenslet has a limited number of pixels; more views are interpolated.
  if (double const seen = written.camera.picture_px(); across > 2 * seen) {
    log_warning({WarningCode::unsuitable, "--views",
                 fmt::format("{} views of each frame will be written, although the image of the stop behind a lenslet "
                             "is {:.3g} px wide (views between pixels are interpolated and contain no new "
                             "information); --views {} gives one view per pixel",
                             written.views, seen, std::max(1, static_cast<int>(std::ceil(seen))))});
  }
  OutputFolder output(folder, {marker, {"view_*.tif", "*_refocused.tif"}});
  output.fill([&](std::string const& place) {
    for (char const* const file : {case_file::reference, case_file::flow}) {
      ImageMetadata metadata;
      Image<double> const raw = read_image(in_case(case_folder, file), &metadata);
      PlenopticViews const views(written.camera, raw);
      fs::path const frame = fs::path(place) / fs::path(file).stem();
      fs::create_directories(frame);
      auto const write = [&](fs::path const& path, Image<double> const& levels) {
        written.columns = levels.columns();
        written.rows = levels.rows();
        write_tiff(path.string(), rounded_levels(levels), {metadata.bit_depth, written.camera.lenslets.pitch, ""});
      };
      for (Vec2d const s : stops) write(frame / name_of(s), views.view(s));
      if (distance) write(frame.string() + "_refocused.tif", views.refocused(stops, *distance));
    }
    written.json = json_text(summary);
    OutputFile::write_text((fs::path(place) / marker).string(), written.json + "\n");
  });
  output.commit();
  return written;
}

}  // namespace gladstone::inline cases
