#include "studies/case/plenoptic_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/base/parallel.h"

namespace gladstone::inline cases {

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

}  // namespace gladstone::inline cases
