#include "render/light/laser_sheet.h"

#include <fmt/format.h>

namespace gladstone {
namespace {

/// How far from square a sheet's normal may stand on its laser's direction: what rounded components leave. [1]
constexpr double square_enough = 0.01;

Vec3d read_unit_vector(SetupTable& table, std::string const& key, Vec3d fallback) {
  auto const parts = table.numbers(key, {fallback.x, fallback.y, fallback.z}, 3, {-1e9, 1e9});
  if (parts.size() != 3) return fallback;
  Vec3d const vector{parts[0], parts[1], parts[2]};
  if (length(vector) < 1e-9) {
    table.problem(key, "has no length (it is a direction in X, Y, Z); give one, as [1.0, 0.0, 0.0]");
    return fallback;
  }
  return normalized(vector);
}

/// Two numbers, one for either pulse.
std::array<double, 2> read_pair(SetupTable& table, std::string const& key, Range range) {
  auto const pair = table.numbers(key, {0, 0}, 2, range);
  return pair.size() == 2 ? std::array{pair[0], pair[1]} : std::array{0.0, 0.0};
}

}  // namespace

LaserSetup read_laser_setup(SetupTable table, double wavelength) {
  LaserSetup laser;
  laser.wavelength =
      table.number("wavelength_nm", wavelength / unit::nanometre, {100.0, 20000.0, false, false}) * unit::nanometre;
  laser.pulse_energy = table.number("pulse_energy_mj", 50.0, Range::positive(1e9)) * 1e-3;
  laser.direction = read_unit_vector(table, "direction", laser.direction);
  laser.normal = read_unit_vector(table, "normal", laser.normal);
  double const lean = dot(laser.direction, laser.normal);
  if (std::abs(lean) > square_enough) {
    table.problem(
        table.has("normal") ? "normal" : "direction",
        fmt::format("leaves {:.4g} deg between the sheet's normal and the laser's direction (a sheet holds its "
                    "laser's direction, so that they are square); turn one of them",
                    std::acos(std::min(std::abs(lean), 1.0)) / unit::degree));
    // any normal that is square, to go on reading with
    Vec3d const other = std::abs(laser.direction.z) < 0.7 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
    laser.normal = other;
  }
  laser.normal = normalized(laser.normal - dot(laser.direction, laser.normal) * laser.direction);
  auto const centre = table.numbers("center_mm", {0, 0, 0}, 3, {-1e9, 1e9});
  if (centre.size() == 3) laser.centre = Vec3d{centre[0], centre[1], centre[2]} * unit::millimetre;
  if (table.word("profile", "gaussian", {"gaussian", "top_hat"}) == "top_hat") laser.profile = SheetProfile::top_hat;
  laser.thickness = table.number("thickness_mm", 1.0, Range::positive(1e6)) * unit::millimetre;
  laser.height = table.number("height_mm", 40.0, Range::positive(1e6)) * unit::millimetre;
  laser.divergence = table.number("divergence_deg", 0.0, {-120.0, 120.0}) * unit::degree;
  laser.polarization = table.number("polarization_deg", 0.0, {-360.0, 360.0}) * unit::degree;
  laser.offset = read_pair(table, "offset_mm", {-1e6, 1e6});
  laser.tilt = read_pair(table, "tilt_deg", {-80.0, 80.0});
  for (double& offset : laser.offset) offset *= unit::millimetre;
  for (double& tilt : laser.tilt) tilt *= unit::degree;
  return laser;
}

template <class T>
LaserSheet<T> laser_sheet(LaserSetup const& setup) {
  auto const narrow = [](Vec3d v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
  LaserSheet<T> sheet;
  Vec3d const height_axis = cross(setup.normal, setup.direction);
  for (std::size_t pulse = 0; pulse < 2; ++pulse) {
    Pose<double> const pose = Pose<double>{setup.centre, setup.direction, height_axis, setup.normal}
                                  .moved({0, 0, setup.offset[pulse]})
                                  .turned({setup.tilt[pulse], 0, 0});
    sheet.pose[pulse] = {narrow(pose.origin), narrow(pose.x), narrow(pose.y), narrow(pose.z)};
  }
  sheet.profile = setup.profile;
  sheet.pulse_energy = T(setup.pulse_energy);
  sheet.thickness = T(setup.thickness);
  sheet.height = T(setup.height);
  sheet.growth = T(2 * std::tan(setup.divergence / 2));
  sheet.cos_polarization = T(std::cos(setup.polarization));
  sheet.sin_polarization = T(std::sin(setup.polarization));
  sheet.photons_per_joule = T(setup.wavelength / (constant::planck * constant::speed_of_light));
  return sheet;
}

template LaserSheet<double> laser_sheet(LaserSetup const& setup);
template LaserSheet<float> laser_sheet(LaserSetup const& setup);

}  // namespace gladstone
