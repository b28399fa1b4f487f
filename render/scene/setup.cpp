#include "render/scene/setup.h"

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/scene/build_camera.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone::inline scene {

double Setup::focus_distance() const {
  switch (lens.focus) {
    case Focus::target:
      return z_b();
    case Focus::medium:
      return z_a;
    case Focus::distance:
      break;
  }
  return lens.focus_distance;
}

std::string Setup::reason_against_closed_form() const {
  if (lens.prescription) return "the lens is a prescription";
  if (pose) return "the camera is not on the Z axis (camera.pose)";
  if (!elements.empty())
    return "there are optical elements besides the lens (" + std::string(elements.front().kind()) + ")";
  if (camera.tilted()) return "the sensor is tilted";
  return camera.distorted() ? "the lens distorts" : "";
}

bool Setup::has_refracting_elements() const {
  return std::any_of(elements.begin(), elements.end(),
                     [](OpticalElement const& element) { return element.side() != ElementSide::image_plane; });
}

bool Setup::divides_light() const {
  return std::any_of(elements.begin(), elements.end(),
                     [](OpticalElement const& element) { return element.divides_light(); });
}

bool Setup::has_oblique_view() const {
  return pose || camera.tilted() || std::any_of(elements.begin(), elements.end(), [](OpticalElement const& element) {
           return element.deflects();
         });
}

double Setup::element_shift(ElementSide side) const {
  double shift = 0;
  for (OpticalElement const& element : elements) {
    if (element.side() == side) shift += element.shift();
  }
  return shift;
}

ImagingGeometry Setup::imaging() const {
  if (!lens.prescription && !has_refracting_elements()) {
    return thin_lens_imaging(lens.focal_length, lens.f_number, focus_distance(), z_b());
  }
  return paraxial_imaging(*this, paraxial_camera(*this));
}

Vec2d Setup::target_centre() const { return target.centre_m ? *target.centre_m : axis_on_target(); }

Vec2d Setup::axis_on_target() const {
  if (!pose) return {};
  Vec3d const there = pose->origin - z_b() * pose->z;
  return {there.x, there.y};
}

Vec2d Setup::target_extent() const {
  if (target.extent_m) return *target.extent_m;
  if (has_oblique_view()) return posed_extent(*this);
  // Compute in mm, so that the resolved setup, which stores mm, reproduces the dots to the last bit.
  double const px_mm = camera.pixel_pitch / imaging().magnification / unit::millimetre;
  Vec2d const view_mm{(camera.columns + 2.0 * view_margin_px) * px_mm, (camera.rows + 2.0 * view_margin_px) * px_mm};
  return view_mm * unit::millimetre + target_view_margin();
}

Vec2d Setup::target_view_margin() const {
  Vec2d const off = target_centre() - axis_on_target();
  return {2 * std::abs(off.x), 2 * std::abs(off.y)};
}

double Setup::dot_diameter() const {
  if (target.dot_diameter_m) return *target.dot_diameter_m;
  double const diameter_px = target.dot_diameter_px.value_or(0.0);
  if (has_oblique_view()) return diameter_px * pixel_size();
  return diameter_px * camera.pixel_pitch / imaging().magnification;
}

double Setup::pixel_size() const {
  return has_oblique_view() ? posed_pixel_size(*this) : camera.pixel_pitch / imaging().magnification;
}

double Setup::spot_scale_px() const {
  ImagingGeometry const geometry = imaging();
  if (geometry.entrance_pupil == 0) return 0;
  for (OpticalElement const& element : elements) {
    if (double const own = element.image_f_number(); own > 0) return own * medium.wavelength / camera.pixel_pitch;
  }
  return geometry.image_distance / geometry.entrance_pupil * medium.wavelength / camera.pixel_pitch;
}

double Setup::spot_diameter_px() const {
  if (lens.spot == SpotModel::none) return 0;
  return SpotSize{spot_scale_px()}.first_zero_diameter() * (lens.spot == SpotModel::seed_eq8 ? pi : 1.0);
}

double Setup::spot_e2_diameter_px() const {
  SpotSize const spot{spot_scale_px()};
  switch (lens.spot) {
    case SpotModel::gaussian:
    case SpotModel::airy:
      return 4 * spot.matched_sigma();
    case SpotModel::gaussian_first_zero:
      return spot.first_zero_diameter();
    case SpotModel::seed_eq8:
      return pi * spot.first_zero_diameter();
    case SpotModel::none:
      break;
  }
  return 0;
}

double Setup::defocus_diameter_px() const {
  ImagingGeometry const geometry = imaging();
  // The image of a point at distance Z by a lens focused at F is a disc of diameter M_F D_a |Z - F| / Z.
  double const focus = focus_distance(), magnification = geometry.image_distance / focus;
  return magnification * geometry.entrance_pupil * std::abs(z_b() - focus) / z_b() / camera.pixel_pitch;
}

double Setup::pixel_area() const {
  if (has_oblique_view()) return posed_view_area(*this) / (camera.columns * camera.rows);
  double const px = camera.pixel_pitch / imaging().magnification;
  return px * px;
}

double Setup::dot_count() const {
  Vec2d const extent = target_extent();
  return std::round(target.dots_per_32px_window / 1024.0 * extent.x * extent.y / pixel_area());
}

}  // namespace gladstone::inline scene
