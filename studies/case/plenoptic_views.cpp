#include "studies/case/plenoptic_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/units.h"
#include "render/files/image_file.h"
#include "render/files/output_file.h"
#include "render/files/output_folder.h"
#include "studies/case/case.h"
#include "studies/case/json_text.h"
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

PlenopticCamera PlenopticCamera::of(Setup const& setup, std::string const& where) {
  auto const refuse = [&where](std::string const& why) { throw DataError(ErrorCode::unsupported, where, why); };
  auto const* const lenslets = setup.element<LensletSetup>();
  if (!lenslets) refuse("its camera has no [camera.lenslets], so that each image is a single view");
  if (setup.lens.prescription) refuse("its lens is a prescription; views require an ideal thin lens");
  ImagingGeometry const imaging = setup.imaging();
  if (!(imaging.entrance_pupil > 0)) refuse("its lens has no stop (lens.f_number = inf), and therefore a single view");
  return {setup.lens.focal_length, imaging.entrance_pupil, imaging.image_distance, *lenslets, setup.camera.pixel_pitch};
}

double PlenopticCamera::parallax(double distance) const {
  double const v_inverse = 1 / focal_length - 1 / distance;
  return (1 - image_distance * v_inverse) / lenslets.pitch;
}

PlenopticViews::PlenopticViews(PlenopticCamera const& camera, Image<double> const& raw) : camera_(camera), raw_(raw) {
  // Count the lenslets for which the centre of the stop's image is on the sensor.
  double const apart =
      (1 + camera.lenslets.to_sensor / camera.image_distance) * camera.lenslets.pitch / camera.pixel_pitch;
  half_columns_ = static_cast<int>(0.5 * (raw.columns() - 1) / apart);
  half_rows_ = static_cast<int>(0.5 * (raw.rows() - 1) / apart);
}

double PlenopticViews::raw_at(Vec2d pixel) const {
  double const x = std::clamp(pixel.x, 0.0, raw_.columns() - 1.0), y = std::clamp(pixel.y, 0.0, raw_.rows() - 1.0);
  int const i = static_cast<int>(x), j = static_cast<int>(y);
  int const right = std::min(i + 1, raw_.columns() - 1), below = std::min(j + 1, raw_.rows() - 1);
  double const upper = raw_(i, j) + (x - i) * (raw_(right, j) - raw_(i, j));
  double const lower = raw_(i, below) + (x - i) * (raw_(right, below) - raw_(i, below));
  return upper + (y - j) * (lower - upper);
}

// The lens inverts, but the image does not: the sensor's x and y point right and up as the camera sees them.
double PlenopticViews::of_lenslet(Vec2d axis, Vec2d s) const {
  Vec2d const on_sensor = axis + (camera_.lenslets.to_sensor / camera_.image_distance) * (axis - s);
  Vec2d const middle{0.5 * (raw_.columns() - 1), 0.5 * (raw_.rows() - 1)};
  return raw_at(middle + Vec2d{-on_sensor.x, on_sensor.y} / camera_.pixel_pitch);
}

double PlenopticViews::level(Vec2d place, Vec2d s) const {
  double const pitch = camera_.lenslets.pitch;
  bool const hexagonal = camera_.lenslets.layout == LensletLayout::hexagonal;
  double const height = hexagonal ? std::sqrt(0.75) * pitch : pitch;
  double const row = std::floor(place.y / height), up = place.y / height - row;
  auto const along = [&](double in_row) {
    double const shift = hexagonal && std::fmod(std::abs(in_row), 2.0) == 1.0 ? 0.5 : 0.0;
    double const first = std::floor(place.x / pitch - shift), part = place.x / pitch - shift - first;
    Vec2d const axis{(first + shift) * pitch, in_row * height};
    double const left = of_lenslet(axis, s);
    return part > 0 ? left + part * (of_lenslet(axis + Vec2d{pitch, 0}, s) - left) : left;
  };
  double const lower = along(row);
  return up > 0 ? lower + up * (along(row + 1) - lower) : lower;
}

template <class Level>
Image<double> PlenopticViews::picture(Level const& level) const {
  Image<double> image(2 * half_columns_ + 1, 2 * half_rows_ + 1);
  parallel_for(static_cast<std::size_t>(image.rows()), [&](std::size_t row) {
    for (int column = 0; column < image.columns(); ++column) {
      Vec2d const lenslet{static_cast<double>(half_columns_ - column), static_cast<double>(row) - half_rows_};
      image(column, static_cast<int>(row)) = level(camera_.lenslets.pitch * lenslet);
    }
  });
  return image;
}

Image<double> PlenopticViews::view(Vec2d s) const {
  return picture([&](Vec2d place) { return level(place, s); });
}

Image<double> PlenopticViews::refocused(std::vector<Vec2d> const& stops, double distance) const {
  double const moves = camera_.parallax(distance) * camera_.lenslets.pitch;
  return picture([&](Vec2d place) {
    double sum = 0;
    for (Vec2d const s : stops) sum += level(place + moves * s, s);
    return sum / static_cast<double>(stops.size());
  });
}

std::vector<Vec2d> stop_positions(double diameter, int across) {
  std::vector<Vec2d> places;
  auto const at = [&](int i) { return diameter * ((i + 0.5) / across - 0.5); };
  for (int row = 0; row < across; ++row) {
    for (int column = 0; column < across; ++column) {
      Vec2d const place{at(column), -at(row)};
      if (2 * length(place) <= diameter) places.push_back(place);
    }
  }
  return places;
}

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
