#include <algorithm>
#include <cmath>

#include "render/rays/ray_requirement.h"
#include "render/scene/particle_scene.h"
#include "render/scene/particle_warnings.h"
#include "render/setup/setup_node.h"
#include "studies/case/case_warnings.h"
#include "studies/case/expected_particles.h"
#include "studies/case/kinds/shared_parts.h"
#include "studies/case/particle_case.h"
#include "studies/case/write_case.h"

namespace gladstone::inline cases {
namespace {

ImageDiameters images_of_particles(Setup const& setup) {
  ExpectedParticleImage const image = particle_image(setup);
  return {image.geometric_px, image.diffraction_px, image.blur_px, image.distance};
}

/// Returns the number of particles that are lit and in view; NaN: unknown before their file is read.
double lit_particles(Scene const& scene) {
  Setup const& setup = scene.setup;
  return expected_particles(setup).per_pixel * setup.camera.columns * setup.camera.rows;
}

/// Estimates the number of rays that "auto" chooses for most particles, without aberrations and refraction: that of
/// cubature_rule_suffices() for the brightest particle at the edge of the laser sheet, at least the second rule.
/// @param largest  largest number that may be chosen
double expected_rays_of_particles(Setup const& setup, double largest) {
  // number of rays of the second quadrature rule; level of the brightest pixel relative to full scale
  constexpr double second_rule = 16, exposure = 0.9;
  if (setup.divides_light()) return largest;
  ExpectedParticles const images = expected_particles(setup);
  double const spot2 = images.diffraction_px * images.diffraction_px;
  double const blur2 = images.sheet_edge_diameter_px * images.sheet_edge_diameter_px - spot2;
  double const allowed = image_tolerance_levels / (exposure * std::exp2(setup.camera.bit_depth));
  double n = second_rule;
  while (n < largest && !cubature_rule_suffices(n, std::max(blur2, 0.0) / spot2, allowed)) n *= 4;
  return std::min(n, largest);
}

/// Sets the number of particles of all cameras to that required by the first camera's image.
void share_particles(std::vector<CameraCase>& cameras) {
  Setup const& first = cameras.front().loaded.setup;
  if (first.piv->particles.count != ParticleCount::per_pixel) return;
  SetupNode const number = setup_number(std::round(particle_count(first)));
  for (CameraCase& one : cameras) {
    SetupDocument& document = one.loaded.document;
    document.remove({"particles", "per_pixel"});
    document.set({"particles", "number"}, number);
    PivSetup& piv = *one.loaded.setup.piv;
    piv.particles = read_particle_setup(document.reread("particles"), piv.laser.wavelength);
  }
}

void warn_of_unsuitable_particles(Scene const& scene, Warnings& warnings) {
  warn(warnings, warnings_of_particles(scene));
}

void write_truth_of_particles(std::string const& path, Scene const& scene, Rendering const& rendering,
                              CaseOutcome const& /*outcome*/, FileOrigin const& origin) {
  write_particle_truth(path, scene, rendering, origin);
}

}  // namespace

constinit CaseKind const piv_case_kind{.experiment = piv_experiment,
                                       .cross_check = cross_check_windows,
                                       .expected_images = images_of_particles,
                                       .expected_sources = lit_particles,
                                       .expected_rays = expected_rays_of_particles,
                                       .share_sources = share_particles,
                                       .render = render_pair,
                                       .warn_of_view = warn_of_unsuitable_particles,
                                       .write_truth = write_truth_of_particles,
                                       .own_summary = particle_summary};

}  // namespace gladstone::inline cases
