#include "render/light/laser_sheet.h"

#include <fmt/format.h>

namespace gladstone::inline light {
namespace {

/// Largest accepted |cosine| of the angle between sheet normal and laser direction; allows for rounded components [1].
constexpr double square_enough = 0.01;

Vec3d read_unit_vector(SetupTable& table, std::string const& key, Vec3d fallback) {
  auto const parts = table.numbers(key, {fallback.x, fallback.y, fallback.z}, 3, {-1e9, 1e9});
  if (parts.size() != 3) return fallback;
  Vec3d const vector{parts[0], parts[1], parts[2]};
  if (length(vector) < 1e-9) {
    table.problem(key, "is zero (a direction in X, Y, Z is needed); give one such as [1.0, 0.0, 0.0]");
    return fallback;
  }
  return normalized(vector);
}

}  // namespace

LaserSetup read_laser_setup(SetupTable table, double wavelength) {
  LaserSetup laser;
  laser.wavelength =
      table.number("wavelength_nm", wavelength / unit::nanometre, {100.0, 20000.0, false, false}) * unit::nanometre;
  laser.pulse_energy = table.quantity("pulse_energy_mj", laser.pulse_energy, unit::millijoule, Range::positive(1e9));
  laser.direction = read_unit_vector(table, "direction", laser.direction);
  laser.normal = read_unit_vector(table, "normal", laser.normal);
  double const lean = dot(laser.direction, laser.normal);
  if (std::abs(lean) > square_enough) {
    table.problem(table.has("normal") ? "normal" : "direction",
                  fmt::format("makes an angle of {:.4g} deg between the sheet's normal and the laser's direction (they "
                              "must be perpendicular, since the beam lies in the sheet); rotate one of them",
                              std::acos(std::min(std::abs(lean), 1.0)) / unit::degree));
    // replace the normal by one that is not parallel to the direction, so that reading can continue
    Vec3d const other = std::abs(laser.direction.z) < 0.7 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
    laser.normal = other;
  }
  laser.normal = normalized(laser.normal - dot(laser.direction, laser.normal) * laser.direction);
  laser.centre = table.quantities("center_mm", laser.centre, unit::millimetre, {-1e9, 1e9});
  laser.profile = table.choice("profile", laser.profile,
                               {{"gaussian", SheetProfile::gaussian}, {"top_hat", SheetProfile::top_hat}});
  laser.thickness = table.quantity("thickness_mm", laser.thickness, unit::millimetre, Range::positive(1e6));
  laser.height = table.quantity("height_mm", laser.height, unit::millimetre, Range::positive(1e6));
  laser.divergence = table.quantity("divergence_deg", laser.divergence, unit::degree, {-120.0, 120.0});
  laser.polarization = table.quantity("polarization_deg", laser.polarization, unit::degree, {-360.0, 360.0});
  Vec2d const offset = table.quantities("offset_mm", Vec2d{}, unit::millimetre, {-1e6, 1e6});
  Vec2d const tilt = table.quantities("tilt_deg", Vec2d{}, unit::degree, {-80.0, 80.0});
  laser.offset = {offset.x, offset.y};
  laser.tilt = {tilt.x, tilt.y};
  return laser;
}

LaserSheet<double> laser_sheet(LaserSetup const& setup) {
  LaserSheet<double> sheet;
  Vec3d const height_axis = cross(setup.normal, setup.direction);
  for (std::size_t pulse = 0; pulse < 2; ++pulse) {
    sheet.pose[pulse] = Pose<double>{setup.centre, setup.direction, height_axis, setup.normal}
                            .moved({0, 0, setup.offset[pulse]})
                            .turned({setup.tilt[pulse], 0, 0});
  }
  sheet.profile = setup.profile;
  sheet.pulse_energy = setup.pulse_energy;
  sheet.thickness = setup.thickness;
  sheet.height = setup.height;
  sheet.growth = 2 * std::tan(setup.divergence / 2);
  sheet.cos_polarization = std::cos(setup.polarization);
  sheet.sin_polarization = std::sin(setup.polarization);
  sheet.photons_per_joule = setup.wavelength / (constant::planck * constant::speed_of_light);
  return sheet;
}

}  // namespace gladstone::inline light
