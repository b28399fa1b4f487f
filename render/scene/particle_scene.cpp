#include "render/scene/particle_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "render/base/parallel.h"
#include "render/base/units.h"
#include "render/scene/build_camera.h"
#include "render/scene/ideal_projection.h"
#include "render/scene/light_through_lens.h"
#include "render/scene/read_setup.h"

namespace gladstone::inline scene {
namespace {

constexpr double bending_margin = 0.02;       // maximum deflection by media on the way to the lens [rad]
constexpr double scattering_contrast = 1e-3;  // minimum index difference; seeding particles in gas have 0.3 or more
constexpr double lit_share = 0.5;             // illuminated fraction of the volume below which a warning is issued
constexpr double kept_pairs = 0.75;           // minimum fraction of paired particles: Keane & Adrian's one-quarter rule

/// Returns the fraction of the particles' volume that the camera sees, sampled by low-discrepancy points: an additive
/// recurrence in X and Y (Roberts 2018: powers of the real root of x^3 = x + 1) and another one in Z.
double seen_share(Setup const& setup) {
  constexpr int places = 1 << 14;
  constexpr double root = 1.32471795724474602596, along_z = 0.41421356237309504880;
  Camera const camera = build_camera(setup);
  bool const closed_form = setup.has_closed_form_layout();
  IdealProjection const ideal{setup.imaging().image_distance, setup.z_a, setup.camera.pixel_pitch, setup.camera.columns,
                              setup.camera.rows};
  ParticleSetup const& particles = setup.piv->particles;
  std::vector<char> seen(places);
  parallel_chunks(places, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      auto const part = [i](double step) {
        double const x = 0.5 + static_cast<double>(i + 1) * step;
        return x - std::floor(x) - 0.5;
      };
      Vec3d const at{part(1 / root) * particles.volume->x, part(1 / (root * root)) * particles.volume->y,
                     part(along_z) * particles.volume->z};
      Vec3d const place = particles.center + at;
      auto const pixel = closed_form && place.z < setup.z_a ? std::optional(ideal(place)) : camera.project(place);
      seen[i] = pixel && camera.sensor.covers(*pixel) ? 1 : 0;
    }
  });
  return static_cast<double>(std::count(seen.begin(), seen.end(), 1)) / places;
}

/// Returns the range of scattering angles of light from all particles to the lens.
AngleInterval seen_angles(Scene const& scene) {
  LaserSheet<double> const sheet = laser_sheet(scene.setup.piv->laser);
  AngleInterval angles{pi, 0};
  Vec3d const lens = scene.camera.aim_plane.origin;
  for (int pulse = 0; pulse < 2; ++pulse) {
    for (Vec3d const& place : scene.particles.place[pulse]) {
      Vec3d const way = lens - place;
      double const far = length(way), cosine = dot(way, sheet.wave(place, pulse).propagation) / far;
      double const angle = std::acos(std::clamp(cosine, -1.0, 1.0));
      double const around = bending_margin + 1.5 * scene.imaging.entrance_pupil / far;
      angles = {std::min(angles.least, angle - around), std::max(angles.most, angle + around)};
    }
  }
  return {std::max(0.0, angles.least), std::min(pi, angles.most)};
}

/// Returns the distance of the volume from a sheet's middle plane at a pulse [m]; 0 if they intersect.
double sheet_beside(ParticleSetup const& particles, Pose<double> const& sheet) {
  Vec3d const half = 0.5 * *particles.volume, n = sheet.z;
  double const reach = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
  return std::max(0.0, std::abs(dot(particles.center - sheet.origin, n)) - reach);
}

/// Reports a velocity file that ends inside the particles' volume. A file that cannot be read is ignored; its reader
/// reports it.
void cross_check_velocity_file(Setup const& setup, SetupTable flow) {
  ParticleSetup const& particles = setup.piv->particles;
  if (!particles.volume) return;
  try {
    RegularGrid const grid = velocity_grid(*setup.piv->flow.file);
    double const mm = unit::millimetre;
    for (int axis = 0; axis < 3; ++axis) {
      auto const a = static_cast<std::size_t>(axis);
      if (grid.periodic[a] || (axis == 2 && grid.nodes[2] == 1)) continue;
      double const low = grid.origin[axis], high = low + grid.spacing[axis] * (grid.nodes[a] - 1);
      double const half = (*particles.volume)[axis] / 2, middle = particles.center[axis];
      double const rounding = 1e-9 * (high - low);
      if (middle - half >= low - rounding && middle + half <= high + rounding) continue;
      flow.problem(
          "file",
          fmt::format(
              "contains a velocity field from {} = {:.6g} to {:.6g} mm, which ends inside the particles' volume, "
              "{:.6g} to {:.6g} mm; make particles.volume_mm smaller, or check flow.spacing_mm, center_mm and periodic",
              "XYZ"[axis], low / mm, high / mm, (middle - half) / mm, (middle + half) / mm));
    }
  } catch (DataError const&) {
  }
}

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
  constexpr int along = 16;            // number of points along each side of the view
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

/// @throws DataError if no particle is illuminated at either pulse
void require_light(Particles const& particles) {
  auto const lit = [&particles](int pulse) {
    return std::any_of(particles.photons[pulse].begin(), particles.photons[pulse].end(),
                       [](double p) { return p > 0; });
  };
  if (!lit(0) && !lit(1)) {
    throw DataError(ErrorCode::invalid_value, KeyPath{"laser"},
                    "illuminates no particle (none lies in the sheet at either pulse); check laser.offset_mm, "
                    "particles.volume_mm and center_mm, or seed more particles");
  }
}

/// Adds the scattering table of the scene's particles.
void add_scattering(Scene& scene) {
  PivSetup const& piv = *scene.setup.piv;
  if (piv.particles.scattering != ParticleScattering::mie) return;
  MieSetting const setting{piv.particles.index, piv.laser.wavelength, scene.setup.ambient_index()};
  scene.mie = std::make_shared<MieScattering const>(scene.particles.diameter, setting, seen_angles(scene));
}

/// Returns the photons of the brightest particle of the scene; 1 without particles.
double determine_photon_unit(Scene const& scene) {
  double const brightest = brightest_photons(scene, scene.particles, ParticleLight::scattered);
  return brightest > 0 ? brightest : 1;
}

/// Adds the particles of a pair of a sequence. The unit of light is that of the first pair, so that exposures and grey
/// levels of all pairs are comparable.
void add_particles_of_sequence(Scene& scene) {
  PivSetup& piv = *scene.setup.piv;
  auto const shared = scene.setup.shared_particles ? scene.setup.shared_particles : std::make_shared<ParticleCache>();
  if (!shared->sequence) {
    shared->flow_warnings = load_flow(piv.flow);
    double const count = piv.particles.count == ParticleCount::file ? 0 : particle_count(scene.setup);
    shared->sequence.emplace(piv.particles, count, piv.flow, laser_sheet(piv.laser),
                             path_tolerance_px * scene.setup.pixel_size());
  }
  piv.flow = shared->sequence->flow();
  scene.flow_warnings = shared->flow_warnings;
  auto const add_pair = [&](std::size_t pair) {
    scene.particles = shared->sequence->pair(pair);
    require_light(scene.particles);
    add_scattering(scene);
  };
  if (!(shared->photon_unit > 0)) {
    add_pair(0);
    shared->photon_unit = determine_photon_unit(scene);
  }
  std::size_t const pair = scene.setup.sequence->pair;
  if (pair > 0 || scene.particles.size() == 0) add_pair(pair);
  scene.photon_unit = shared->photon_unit;
}

}  // namespace

double particle_count(Setup const& setup) {
  ParticleSetup const& particles = setup.piv->particles;
  Vec3d const v = *particles.volume;
  switch (particles.count) {
    case ParticleCount::per_mm3:
      return particles.amount * v.x * v.y * v.z / std::pow(unit::millimetre, 3);
    case ParticleCount::per_pixel: {
      double const pixels = static_cast<double>(setup.camera.columns) * setup.camera.rows, share = seen_share(setup);
      if (!(share > 0))
        throw DataError(ErrorCode::invalid_value, KeyPath{"particles.volume_mm"},
                        "lies entirely outside the camera's view; check center_mm");
      return particles.amount * pixels / share;
    }
    case ParticleCount::number:
    case ParticleCount::file:
      break;
  }
  return particles.amount;
}

MemoryRequirement particle_memory(Setup const& setup) {
  ParticleSetup const& particles = setup.piv->particles;
  if (particles.count == ParticleCount::file) return {"particles.file", "particles", 0};
  char const* const key = particles.count == ParticleCount::per_mm3     ? "particles.per_mm3"
                          : particles.count == ParticleCount::per_pixel ? "particles.per_pixel"
                                                                        : "particles.number";
  double const margins = setup.sequence ? 4 : 2;  // pairs of a sequence are seeded at the first pulse, not at mid-time
  Vec3d const v = *particles.volume, wider = v + margins * motion_margin(setup.piv->flow, v, particles.center);
  double const share = wider.x * wider.y * wider.z / (v.x * v.y * v.z);
  return {key, "particles", particle_count(setup) * share * bytes_per_particle};
}

void add_particles(Scene& scene) {
  if (scene.setup.sequence) {
    add_particles_of_sequence(scene);
    return;
  }
  scene.flow_warnings = load_flow(scene.setup.piv->flow);
  PivSetup const& piv = *scene.setup.piv;
  LaserSheet<double> const sheet = laser_sheet(piv.laser);
  double const tolerance = path_tolerance_px * scene.setup.pixel_size();
  scene.particles = piv.particles.count == ParticleCount::file
                        ? read_particles(piv.particles, piv.flow, sheet, tolerance)
                        : seed_particles(piv.particles, particle_count(scene.setup), piv.flow, sheet, tolerance);
  require_light(scene.particles);
  add_scattering(scene);
  scene.photon_unit = determine_photon_unit(scene);
}

ParticleCensus count_particles(Scene const& scene) {
  constexpr double much = 0.1;
  ParticleCensus census;
  Particles const& particles = scene.particles;
  std::vector<char> in_view(particles.size());
  std::vector<double> moved_px(particles.size());
  parallel_chunks(particles.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      auto const first = scene.camera.project(particles.place[0][i]),
                 second = scene.camera.project(particles.place[1][i]);
      in_view[i] = first && scene.camera.sensor.covers(*first) ? 1 : 0;
      if (first && second) moved_px[i] = length(*second - *first);
    }
  });
  for (std::size_t i = 0; i < particles.size(); ++i) {
    double const first = particles.photons[0][i], second = particles.photons[1][i];
    census.lit[0] += first > 0 ? 1 : 0;
    census.lit[1] += second > 0 ? 1 : 0;
    if (!(first > 0) || in_view[i] == 0) continue;
    ++census.in_view;
    census.largest_px = std::max(census.largest_px, moved_px[i]);
    census.paired += second >= much * first ? 1 : 0;
  }
  return census;
}

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

void cross_check_particles(Setup const& setup, SetupTable root, Warnings& warnings) {
  PivSetup const& piv = *setup.piv;
  SetupTable particles = root.table("particles"), laser = root.table("laser");
  double const mm = unit::millimetre;
  if (piv.particles.scattering == ParticleScattering::mie &&
      std::abs(piv.particles.index - setup.ambient_index()) < scattering_contrast) {
    particles.problem(particles.has("material") ? "material" : "index",
                      fmt::format("differs by less than {:g} from that of the surroundings, {:.6g} (such particles "
                                  "scatter hardly any light); use another material",
                                  scattering_contrast, setup.ambient_index()));
  }
  if (std::abs(piv.laser.wavelength - setup.medium.wavelength) > 1e-6 * setup.medium.wavelength) {
    laser.problem("wavelength_nm",
                  fmt::format("is not medium.wavelength_nm = {:.6g} (the camera sees the laser's light, which "
                              "determines n and the point spread function); give both the same value",
                              setup.medium.wavelength / unit::nanometre));
  }
  if (piv.particles.volume) {
    LaserSheet<double> const sheet = laser_sheet(piv.laser);
    double const reach = (piv.laser.profile == SheetProfile::gaussian ? 1.5 : 0.5) * piv.laser.thickness;
    for (int pulse = 0; pulse < 2; ++pulse) {
      double const beside = sheet_beside(piv.particles, sheet.pose[pulse]);
      if (beside <= reach) continue;
      laser.problem(
          "offset_mm",
          fmt::format(
              "puts the sheet of pulse {} outside the particles' volume ({:.4g} mm away, so that no particle is "
              "illuminated); move laser.offset_mm, laser.center_mm, particles.center_mm or thicken particles.volume_mm",
              pulse + 1, beside / mm));
      break;
    }
    Vec3d const far = piv.particles.center + 0.5 * *piv.particles.volume;
    if (!(setup.camera_pose().origin.z > far.z)) {
      particles.problem("volume_mm", "reaches to the lens or beyond it; make it thinner, or move the camera away");
    }
  }
  if (piv.flow.file) cross_check_velocity_file(setup, root.table("flow"));
  for (std::size_t i = 0; i < setup.elements.size(); ++i) {
    OpticalElement const& element = setup.elements[i];
    double const z = element.pose().origin.z, face = z - element.thickness() / 2;
    if (element.side() == ElementSide::target) {
      element_tables(root)[i].table.problem(
          "side",
          "is \"target\", behind the particles, so that their light does not pass it on the way to the camera; use "
          "\"camera\", or remove the element");
    } else if (element.side() == ElementSide::camera && piv.particles.volume &&
               face < piv.particles.center.z + piv.particles.volume->z / 2) {
      element_tables(root)[i].table.problem("position_mm",
                                            fmt::format("puts the element at Z = {:.6g} mm, inside the particles' "
                                                        "volume or behind it; move the element or the volume",
                                                        z / mm));
    }
  }
  if (setup.camera.absolute_exposure && !setup.camera.noise.enabled) {
    warnings.push_back({WarningCode::assumed, "camera.exposure",
                        fmt::format("\"absolute\" uses the default quantum efficiency of {:.3g} and full well of "
                                    "{:.6g}, since there is no table [camera.noise]",
                                    setup.camera.noise.quantum_efficiency, setup.camera.noise.full_well_e)});
  }
}

}  // namespace gladstone::inline scene
