#include "studies/case/expected_particles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/units.h"
#include "render/scene/build_camera.h"
#include "render/scene/light_through_lens.h"
#include "render/scene/particle_scene.h"
#include "render/scene/scene.h"

namespace gladstone::inline cases {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t drawn = 4001;       // number of drawn diameters, so that quantiles are accurate to a few per cent
constexpr double angle_margin = 0.01;     // margin about the scattering angles seen by the lens [rad]
constexpr double visible_snr = 5;         // Rose's criterion
constexpr double largest_tried = 100e-6;  // largest diameter for which the visibility is tested [m]
constexpr double smallest_tried = 10e-9;  // smallest diameter for which the visibility is tested [m]
constexpr int sizes_a_decade = 150;       // diameters tested per decade, 1.5 % apart
constexpr double least_facing = 1e-3;     // cosine of the camera's angle to the sheet's normal below which the sheet is
                                          // seen edge-on [1]

SizeSpread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  auto const at = [&values](double share) {
    return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
  };
  return {at(0.05), at(0.5), at(0.95)};
}

/// Returns the intersection of the camera's axis and the sheet of the first pulse; the sheet's middle if they are
/// parallel.
Vec3d place_in_sheet(Pose<double> const& camera, Pose<double> const& sheet) {
  double const along = dot(camera.z, sheet.z);
  if (std::abs(along) < least_facing) return sheet.origin;
  return camera.origin + dot(sheet.origin - camera.origin, sheet.z) / along * camera.z;
}

/// Returns the illuminated thickness along the sheet's normal within the particles' volume, at most that of the sheet
/// [m].
double lit_thickness(PivSetup const& piv, Pose<double> const& sheet) {
  if (!piv.particles.volume) return piv.laser.thickness;
  Vec3d const volume = *piv.particles.volume, n = sheet.z;
  double half_depth = HUGE_VAL;  // half depth of the volume along the normal, through its centre
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(n[axis]) > 1e-9) half_depth = std::min(half_depth, volume[axis] / 2 / std::abs(n[axis]));
  }
  double const offset = dot(sheet.origin - piv.particles.center, n), half = piv.laser.thickness / 2;
  return std::max(0.0, std::min(half_depth, offset + half) - std::max(-half_depth, offset - half));
}

/// Returns the photons through the lens from particles of these diameters at one point of the sheet.
std::vector<double> photons_of(Scene scene, Vec3d place, std::vector<double> const& diameters) {
  PivSetup const& piv = *scene.setup.piv;
  LaserSheet<double> const sheet = laser_sheet(piv.laser);
  scene.particles.resize(diameters.size());
  scene.particles.diameter = diameters;
  for (int pulse = 0; pulse < 2; ++pulse) {
    std::fill(scene.particles.place[pulse].begin(), scene.particles.place[pulse].end(), place);
    std::fill(scene.particles.photons[pulse].begin(), scene.particles.photons[pulse].end(), sheet.photons(place, 0));
  }
  LightWave<double> const wave = sheet.wave(place, 0);
  if (piv.particles.scattering == ParticleScattering::mie) {
    double const cosine = dot(normalized(scene.camera.aim_plane.origin - place), wave.propagation);
    double const angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    scene.mie = std::make_shared<MieScattering const>(
        diameters, MieSetting{piv.particles.index, piv.laser.wavelength, scene.setup.ambient_index()},
        AngleInterval{std::max(0.0, angle - angle_margin), std::min(pi, angle + angle_margin)});
  }
  std::vector<double> photons(diameters.size());
  for (std::size_t i = 0; i < photons.size(); ++i) photons[i] = photons_through_lens(scene, i, 0);
  return photons;
}

/// Returns the fraction of a centred image's light on its middle pixel.
/// @param sigma_px  standard deviation of the image as a Gaussian [px]
double peak_share(Setup const& setup, double sigma_px) {
  if (setup.lens.spot == SpotModel::airy && setup.spot_scale_px() > 0) {
    AiryTable const airy(setup.spot_scale_px());
    AiryTable::View const view = airy.view();
    return view.share(0, 0, view.half_width, view.half_width);
  }
  if (!(sigma_px > 0)) return 1;
  double const along = std::erf(0.5 / (std::sqrt(2.0) * sigma_px));
  return along * along;
}

/// Returns the peak charge S that equals five times its noise, S = 5 sqrt(S + r^2) [e].
double visible_electrons(NoiseSetup const& noise) {
  double const dark = noise.enabled ? noise.read_noise_e * noise.read_noise_e + noise.dark_current_e : 0.0;
  double const k2 = visible_snr * visible_snr;
  return (k2 + std::sqrt(k2 * k2 + 4 * k2 * dark)) / 2;
}

double smallest_visible(Scene const& scene, Vec3d place, double electrons_per_photon) {
  std::vector<double> diameters;
  double const decades = std::log10(largest_tried / smallest_tried);
  for (int i = 0; i <= decades * sizes_a_decade; ++i) {
    diameters.push_back(smallest_tried * std::pow(10.0, static_cast<double>(i) / sizes_a_decade));
  }
  std::vector<double> const photons = photons_of(scene, place, diameters);
  double const needed = visible_electrons(scene.setup.camera.noise);
  std::size_t first = diameters.size();
  while (first > 0 && photons[first - 1] * electrons_per_photon >= needed) --first;
  return first < diameters.size() ? diameters[first] : unknown;
}

/// Computes the image of a particle.
/// @param diameter  of the particle [m]
/// @param distance  from the lens to the sheet, along the camera's axis [m]
/// @param beyond    distance of the particle behind the sheet [m]
ExpectedParticleImage image_of(Setup const& setup, double diameter, double distance, double beyond) {
  ImagingGeometry const imaging = setup.imaging();
  double const pitch = setup.camera.pixel_pitch, focus = setup.focus_distance();
  ExpectedParticleImage image;
  image.distance = distance;
  image.magnification = imaging.magnification * setup.z_b() / distance;
  image.geometric_px = image.magnification * diameter / pitch;
  image.diffraction_px = setup.spot_e2_diameter_px();
  // circle of confusion of a point `beyond` the sheet, by the magnification at the focus distance
  double const z = distance + beyond - focus, focused = imaging.magnification * setup.z_b() / focus;
  image.blur_px = focused * imaging.entrance_pupil * std::abs(z) / (focus + z) / pitch;
  return image;
}

/// Returns the distance from the camera's front principal plane to the sheet, along the camera's axis [m].
double distance_of_sheet(Setup const& setup) {
  Pose<double> const camera = setup.camera_pose();
  Vec3d const place = place_in_sheet(camera, laser_sheet(setup.piv->laser).pose[0]);
  return std::abs(dot(place - camera.origin, camera.z));
}

}  // namespace

double ExpectedParticleImage::diameter_px() const { return std::hypot(geometric_px, diffraction_px, blur_px); }

ExpectedParticleImage particle_image(Setup const& setup) {
  ParticleSetup const& particles = setup.piv->particles;
  double const median = spread_of(draw_diameters(particles.diameter, particles.seed, drawn)).median;
  return image_of(setup, median, distance_of_sheet(setup), 0);
}

ExpectedParticles expected_particles(Setup const& setup) {
  PivSetup const& piv = *setup.piv;
  Scene scene;
  scene.setup = setup;
  scene.imaging = setup.imaging();
  scene.camera = build_camera(setup);
  Pose<double> const camera = setup.camera_pose(), sheet = laser_sheet(piv.laser).pose[0];
  Vec3d const place = place_in_sheet(camera, sheet);
  double const distance = distance_of_sheet(setup);
  double const pitch = setup.camera.pixel_pitch, facing = std::max(least_facing, std::abs(dot(camera.z, sheet.z)));
  double const working_f_number =
      scene.imaging.entrance_pupil > 0 ? scene.imaging.image_distance / scene.imaging.entrance_pupil : 0;

  ExpectedParticles expected;
  expected.diameter = spread_of(draw_diameters(piv.particles.diameter, piv.particles.seed, drawn));
  auto const image = [&](double beyond) { return image_of(setup, expected.diameter.median, distance, beyond); };
  double const magnification = image(0).magnification;
  expected.magnification = magnification;
  expected.diffraction_px = image(0).diffraction_px;
  auto const sheet_area_of_a_pixel = [&] {
    Pose<double> const there{place, sheet.x, sheet.y, sheet.z};
    auto const seen = scene.camera.see({}, there);
    double const facing_area = std::pow(magnification / pitch, 2);  // image area of a facing sheet [px^2/m^2]
    double const area =
        seen ? std::abs(seen->by_x.x * seen->by_y.y - seen->by_x.y * seen->by_y.x) : facing * facing_area;
    return 1 / std::max(area, least_facing * facing_area);
  };
  double const half_sheet = piv.laser.thickness / 2 / facing;
  expected.image_diameter_px = image(0).diameter_px();
  expected.sheet_edge_diameter_px = std::max(image(half_sheet).diameter_px(), image(-half_sheet).diameter_px());
  expected.depth_of_field = 4.88 * setup.medium.wavelength * std::pow(working_f_number / magnification, 2);

  if (piv.particles.count == ParticleCount::file) {
    expected.per_pixel = unknown;
  } else {
    Vec3d const v = *piv.particles.volume;
    double const in_sheet = particle_count(setup) / (v.x * v.y * v.z) * lit_thickness(piv, sheet);
    expected.per_pixel = in_sheet * sheet_area_of_a_pixel();
  }
  expected.source_density = expected.per_pixel * pi / 4 * std::pow(expected.image_diameter_px, 2);

  double const electrons_per_photon =
      setup.camera.noise.quantum_efficiency * peak_share(setup, expected.image_diameter_px / 4);
  std::vector<double> photons =
      photons_of(scene, place, draw_diameters(piv.particles.diameter, piv.particles.seed, drawn));
  expected.photons = spread_of(photons);
  for (double& one : photons) one *= electrons_per_photon;
  expected.peak_electrons = spread_of(photons);
  auto const full =
      std::count_if(photons.begin(), photons.end(), [&](double peak) { return peak > setup.camera.noise.full_well_e; });
  expected.saturated = static_cast<double>(full) / static_cast<double>(photons.size());
  expected.smallest_visible = smallest_visible(scene, place, electrons_per_photon);
  return expected;
}

}  // namespace gladstone::inline cases
