#include "studies/case/particle_case.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "render/base/not_a_number.h"
#include "render/files/hdf5_axes.h"
#include "render/ideal_images/ideal_images.h"
#include "render/method.h"
#include "render/scene/particle_scene.h"
#include "studies/case/truth_columns.h"

namespace gladstone::inline cases {
namespace {

constexpr std::array<TruthColumn, 7> particle_columns{{
    {"/reference_px", &GroundTruth::reference_px, "px",
     "centroid of the light that passes the stop, at the first pulse; nan: not illuminated, or no ray passes",
     "particle, (column, row)"},
    {"/displacement_px", &GroundTruth::displacement_px, "px",
     "centroid at the second pulse minus that at the first, in the image (u right, v down); nan: not imaged at both",
     "particle, (u, v)"},
    {"/displacement_error_px", &GroundTruth::displacement_error_px, "px",
     "standard error of displacement_px by component (68 % of the errors lie within it); nan: unknown",
     "particle, (u, v)"},
    {"/displacement_std_px", &GroundTruth::displacement_std_px, "px",
     "weighted standard deviation of the rays on the sensor at the second pulse", "particle, (u, v)"},
    {"/reference_ambient_px", nullptr, "px", "as reference_px, without the medium", "particle, (column, row)",
     &ParticleTruth::reference_ambient_px},
    {"/displacement_ambient_px", nullptr, "px", "as displacement_px, without the medium", "particle, (u, v)",
     &ParticleTruth::displacement_ambient_px},
    {"/flux", &GroundTruth::flux, "1", "photons that reach the plane of the sensor at each pulse", "particle, pulse"},
}};

TruthGroup const& particles_group() {
  static TruthGroup const group{
      "/particles",
      "particle",
      "/pulse",
      "pulse",
      "rays counted at each pulse",
      "planned number of rays of the particle at each pulse; 0: not traced, since its light cannot reach the sensor",
      "displacement = second pulse minus first; column right and row down from 0 at the first pixel's centre; the "
      "medium is present at both pulses",
      particle_columns};
  return group;
}

/// Returns minimum, median and maximum of positive numbers.
nlohmann::json spread_of_light(std::vector<double> values) {
  if (values.empty()) return nullptr;
  std::sort(values.begin(), values.end());
  return {{"least", values.front()}, {"median", values[values.size() / 2]}, {"most", values.back()}};
}

}  // namespace

void write_particle_truth(std::string const& path, Scene const& scene, Rendering const& rendering,
                          FileOrigin const& origin) {
  GroundTruth const& truth = rendering.truth;
  Hdf5Writer file(path, origin);
  std::size_t const count = truth.size();
  Hdf5Axes axes(file);
  axes.write_numbers("/component", 2, "u to the right, v downwards; of positions column, row");
  axes.write_numbers("/coordinate", 3, "x, y, z");
  axes.write_numbers("/pulse", 2, "first, second");
  axes.write_numbers("/particles/particle", count, "number of the particle");
  axes.write_numbers("/rays/kind", ray_status_count, "status of a ray");
  std::vector<double> position;
  position.reserve(6 * count);
  for (auto const* const places : {&truth.position_m, &truth.particles.second_m}) {
    for (Vec3d const& p : *places) position.insert(position.end(), {p.x, p.y, p.z});
  }
  file.write("/particles/position_m", std::span<double const>(position), {2, count, 3}, "m",
             "particle positions in the world frame at each pulse: X right, Y up as the camera sees them, Z towards "
             "the camera",
             "pulse, particle, (x, y, z)");
  axes.name("/particles/position_m", {"/pulse", "/particles/particle", "/coordinate"});
  write_sources(file, axes, particles_group(), rendering);
  file.write("/particles/diameter_m", std::span<double const>(truth.particles.diameter_m), {count}, "m",
             "diameter of the particle", "particle");
  axes.name("/particles/diameter_m", {"/particles/particle"});
  axes.attach();
  write_source_attributes(file, particles_group(), scene, rendering.plan);
  file.attribute("/particles", "path_error_m", scene.particles.path.error);
  file.attribute("/particles", "lag_error_m", scene.particles.path.lag_error);
  if (scene.mie) file.attribute("/particles", "scattering_table_error", scene.mie->error());
  file.close();
}

GroundTruth read_particle_truth(std::string const& path) {
  Hdf5Reader const file(path);
  GroundTruth truth;
  std::vector<double> const position = file.read("/particles/position_m");
  std::size_t const count = position.size() / 6;
  require_length(path, "/particles/position_m", position.size(), 6 * count);
  truth.resize(count);
  for (auto* const theory : {&truth.eq9_px, &truth.chief_px, &truth.eq9_cone_px})
    theory->assign(count, {not_a_number, not_a_number});
  truth.particles.second_m.resize(count);
  for (std::size_t i = 0; i < 2 * count; ++i) {
    Vec3d const p{position[3 * i], position[3 * i + 1], position[3 * i + 2]};
    (i < count ? truth.position_m[i] : truth.particles.second_m[i - count]) = p;
  }
  read_sources(file, path, particles_group(), truth);
  truth.particles.diameter_m = file.read("/particles/diameter_m");
  require_length(path, "/particles/diameter_m", truth.particles.diameter_m.size(), count);
  return truth;
}

nlohmann::json particle_summary(Scene const& scene, GroundTruth const& truth, double exposure_e) {
  ParticleCensus const census = count_particles(scene);
  CameraSetup const& camera = scene.setup.camera;
  std::vector<double> photons;
  for (Vec2d const& flux : truth.flux) {
    if (flux.x > 0) photons.push_back(flux.x);
  }
  double const pixels = static_cast<double>(camera.columns) * camera.rows;
  double const px = camera.pixel_pitch / scene.imaging.magnification;
  PathPlan const& path = scene.particles.path;
  bool const by_formula = resolve_render_method(scene) == RenderMethod::formula;
  nlohmann::json particles{
      {"seeded", truth.size()},
      {"lit", {{"first", census.lit[0]}, {"second", census.lit[1]}}},
      {"in_view", census.in_view},
      {"per_pixel", static_cast<double>(census.in_view) / pixels},
      {"paired_fraction", census.in_view > 0
                              ? nlohmann::json(static_cast<double>(census.paired) / static_cast<double>(census.in_view))
                              : nlohmann::json(nullptr)},
      {"not_traced", by_formula ? 0 : std::count(truth.rays_planned.begin(), truth.rays_planned.end(), 0)},
      {"photons", spread_of_light(photons)},
      {"electrons_per_photon", exposure_e / scene.photon_unit},
      {"path", {{"steps", path.steps}, {"error_px", path.error / px}, {"lag_error_px", path.lag_error / px}}}};
  if (auto const ideal = build_ideal_images(scene))
    particles["largest_blur_px"] = ideal->largest_blur_px(scene.particles);
  if (scene.mie) particles["scattering_table_error"] = scene.mie->error();
  return {{"particles", particles}, {"photons_fully_lit", scene.photon_unit}};
}

}  // namespace gladstone::inline cases
