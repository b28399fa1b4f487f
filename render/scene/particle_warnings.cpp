#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "render/base/parallel.h"
#include "render/base/units.h"
#include "render/scene/particle_scene.h"

namespace gladstone::inline scene {
namespace {

constexpr double lit_share = 0.5;    // illuminated fraction of the volume below which a warning is issued
constexpr double kept_pairs = 0.75;  // minimum fraction of paired particles: Keane & Adrian's one-quarter rule

/// Returns a warning if the geometric image of a particle is at least half as wide as PSF or pixel: added in quadrature
/// (Adrian & Yao 1985), it enlarges the image's diameter by an eighth.
std::optional<Warning> warning_of_wide_particles(Scene const& scene) {
  std::vector<double> const& diameter = scene.particles.diameter;
  if (diameter.empty()) return {};
  double const widest = *std::max_element(diameter.begin(), diameter.end()), px = widest / scene.setup.pixel_size();
  double const point_px = std::max(scene.setup.spot_diameter_px(), 1.0);
  if (px <= 0.5 * point_px) return {};
  return Warning{WarningCode::approximated, "particles.diameter_um",
                 fmt::format("the largest, {:.4g} um, has an image {:.2g} px wide, but is rendered as a point ({:.2g} "
                             "px wide by diffraction and pixel size); use smaller ones",
                             widest / unit::micrometre, px, point_px)};
}

/// Returns a warning if the volume ends within the view. Nullopt if it fills the view, is not given, or no particle
/// is in view.
std::optional<Warning> warning_of_small_volume(Scene const& scene, ParticleCensus const& census) {
  constexpr int along = 16;            // points of the view along each side
  constexpr double negligible = 0.01;  // tolerated fraction of these points outside the volume
  ParticleSetup const& particles = scene.setup.piv->particles;
  if (!particles.volume || census.in_view == 0) return {};
  Pose<double> const plane = scene.sheet_plane();
  CameraSetup const& camera = scene.setup.camera;
  double const thickness = scene.setup.piv->laser.thickness;
  // If the volume ends inside the sheet, points of the sheet's middle plane are regarded as inside the volume.
  Vec3d const half =
      0.5 * *particles.volume + thickness * Vec3d{std::abs(plane.z.x), std::abs(plane.z.y), std::abs(plane.z.z)};
  std::vector<char> outside(static_cast<std::size_t>(along) * along);
  std::atomic<int> seen = 0;
  parallel_for(outside.size(), [&](std::size_t i) {
    int const row = static_cast<int>(i) / along, column = static_cast<int>(i) % along;
    Vec2d const share{(column + 0.5) / along, (row + 0.5) / along};
    auto const at = scene.camera.unproject({share.x * camera.columns - 0.5, share.y * camera.rows - 0.5}, plane);
    if (!at) return;
    ++seen;
    Vec3d const off = plane.point_to_outer({at->place.x, at->place.y, 0}) - particles.center;
    outside[i] = std::abs(off.x) > half.x || std::abs(off.y) > half.y || std::abs(off.z) > half.z ? 1 : 0;
  });
  double const share = static_cast<double>(std::count(outside.begin(), outside.end(), 1)) / std::max(1, seen.load());
  if (share < negligible) return {};
  return Warning{
      WarningCode::out_of_view, "particles.volume_mm",
      fmt::format("the volume is smaller than the view: {:.0f} % of the image shows no particles (the sensor sees "
                  "about {:.4g} x {:.4g} mm of the sheet); enlarge volume_mm, or check center_mm",
                  100 * share, camera.columns * scene.setup.pixel_size() * 1e3,
                  camera.rows * scene.setup.pixel_size() * 1e3)};
}

/// Returns a warning if most of the volume is dark, with less than a thousandth of the light in the sheet's middle.
std::optional<Warning> warning_of_dark_volume(Scene const& scene) {
  PivSetup const& piv = *scene.setup.piv;
  if (!piv.particles.volume) return {};
  Pose<double> const sheet = laser_sheet(piv.laser).pose[0];
  Vec3d const half = 0.5 * *piv.particles.volume, n = sheet.z;
  double half_depth = HUGE_VAL;  // half depth of the volume along the sheet's normal, through its centre
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(n[axis]) > 1e-9) half_depth = std::min(half_depth, half[axis] / std::abs(n[axis]));
  }
  // exp(-8 z^2 / w^2) is a thousandth at z = 0.93 w.
  double const reach = (piv.laser.profile == SheetProfile::gaussian ? 0.93 : 0.5) * piv.laser.thickness;
  double const offset = dot(sheet.origin - piv.particles.center, n);
  double const lit = std::max(0.0, std::min(half_depth, offset + reach) - std::max(-half_depth, offset - reach));
  double const share = lit / (2 * half_depth);
  if (!(share < lit_share)) return {};
  return Warning{WarningCode::exposure, "particles.volume_mm",
                 fmt::format("{:.0f} % of the volume lies outside the laser sheet, where particles are counted "
                             "(particles.per_pixel, number) but not seen; make the volume as thin as the sheet, {:.4g} "
                             "mm with its tails, or check laser.offset_mm",
                             100 * (1 - share), 2 * reach / unit::millimetre)};
}

/// Returns a warning if the flow moves particles, but no image by as much as correlation resolves.
std::optional<Warning> warning_of_small_displacements(Scene const& scene, ParticleCensus const& census) {
  if (census.in_view == 0 || !(census.largest_px > 0) || census.largest_px >= measurable_displacement_px) return {};
  return Warning{
      WarningCode::unsuitable, "flow.dt_us",
      fmt::format(
          "displacements are too small to measure: no particle in view moves by more than {:.2g} px (correlation "
          "resolves {} px at best); increase the time between the pulses, to about {:.3g} us for 8 px",
          census.largest_px, measurable_displacement_px,
          8 / census.largest_px * scene.setup.piv->flow.dt / unit::microsecond)};
}

}  // namespace

Warnings warnings_of_particles(Scene const& scene) {
  Warnings warnings;
  ParticleCensus const census = count_particles(scene);
  if (census.in_view == 0) {
    warnings.push_back(
        {WarningCode::out_of_view, "particles",
         fmt::format("all {} particles that are illuminated at the first pulse lie outside the camera's view: the "
                     "images will be "
                     "empty; check particles.center_mm and volume_mm, laser.offset_mm and the position of the camera",
                     census.lit[0])});
  } else if (static_cast<double>(census.paired) < kept_pairs * static_cast<double>(census.in_view)) {
    warnings.push_back(
        {WarningCode::unsuitable, "flow",
         fmt::format("{:.0f} % of the particles in view have left the volume or most of the sheet's light by the "
                     "second pulse (beyond a quarter, correlation suffers; Keane & Adrian 1990); shorten flow.dt_us, "
                     "or use a thicker sheet in a thicker volume",
                     100 - 100.0 * static_cast<double>(census.paired) / static_cast<double>(census.in_view))});
  }
  for (auto const& warning : {warning_of_wide_particles(scene), warning_of_small_volume(scene, census),
                              warning_of_dark_volume(scene), warning_of_small_displacements(scene, census)}) {
    if (warning) warnings.push_back(*warning);
  }
  warnings.insert(warnings.end(), scene.flow_warnings.begin(), scene.flow_warnings.end());
  if (std::size_t const outside = scene.particles.outside_flow; outside > 0) {
    warnings.push_back({WarningCode::assumed, "flow.file",
                        fmt::format("{} of {} particles are outside the velocity field at either pulse (they move with "
                                    "the velocity at its edge); use a larger field, or a smaller particles.volume_mm",
                                    outside, scene.particles.size())});
  }
  PathPlan const& path = scene.particles.path;
  double const px = scene.setup.pixel_size();
  if (path.error > path_tolerance_px * px) {
    warnings.push_back({WarningCode::low_accuracy, "flow",
                        fmt::format("doubling the {} integration steps of a particle's path still changes its end by "
                                    "{:.2g} px; shorten flow.dt_us",
                                    path.steps, path.error / px)});
  }
  if (path.lag_error > 0.01 * px) {
    warnings.push_back({WarningCode::approximated, "particles.density_kg_m3",
                        fmt::format("the lag is computed to first order in the response time only; the second-order "
                                    "term would move particles by another {:.2g} px; use smaller or lighter ones",
                                    path.lag_error / px)});
  }
  return warnings;
}

}  // namespace gladstone::inline scene
