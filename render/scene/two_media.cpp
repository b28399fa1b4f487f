#include "render/scene/two_media.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline scene {
namespace {

constexpr std::size_t sampled = 256;  // number of particles whose scatter is measured
constexpr std::size_t keys = 4;       // number of sets of random numbers over which the scatter is measured

/// Returns a sample of particles, spread evenly over the list.
Particles sample_particles(Particles const& all) {
  std::size_t const count = std::min(all.size(), sampled);
  Particles some = all;
  for (std::size_t i = 0; i < count; ++i) some.copy(i * all.size() / count, i);
  some.resize(count);
  return some;
}

/// Returns the displacements from the first pulse in the first medium to the second pulse in the second medium [px].
std::vector<Vec2d> displacements(GroundTruth const& first, GroundTruth const& second) {
  std::vector<Vec2d> found(first.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i] = second.reference_px[i] + second.displacement_px[i] - first.reference_px[i];
  }
  return found;
}

/// Estimates the standard error of a displacement, rms over a sample of particles and both components [px]; NaN:
/// unknown. Particles are traced with equal light, since the scattering of the sampled particles is not needed and
/// their indices do not match those of scene.mie.
double standard_error(Renderer& renderer, Scene const& scene, RenderPlan const& plan, Particles const& particles) {
  Particles const some = sample_particles(particles);
  std::array<std::vector<Vec2d>, keys> found;
  Scene const first = select_first_pulse(scene), second = select_second_pulse(scene);
  for (std::size_t key = 0; key < keys; ++key) {
    RenderPlan keyed = plan;
    keyed.seed += 7919 * (key + 1);
    auto const trace = [&](Scene const& one) {
      return renderer.render_particles(one, keyed, some, ParticleLight::equal, RenderImages::no).truth;
    };
    found[key] = displacements(trace(first), trace(second));
  }
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < some.size(); ++i) {
    Vec2d mean{};
    for (auto const& one : found) mean += one[i] / static_cast<double>(keys);
    if (!std::isfinite(mean.x)) continue;
    for (auto const& one : found) sum += dot(one[i] - mean, one[i] - mean);
    count += 2.0 * (keys - 1);
  }
  return count > 0 ? std::sqrt(sum / count) : not_a_number;
}

}  // namespace

Scene select_first_pulse(Scene const& scene) {
  Scene first = scene;
  first.second_medium.reset();
  return first;
}

Scene select_second_pulse(Scene const& scene) {
  GLADSTONE_EXPECTS(scene.second_medium);
  Scene second = scene;
  second.medium = *scene.second_medium;
  second.second_medium.reset();
  second.setup.medium.field = *scene.setup.medium.second_field;
  second.setup.medium.second_field.reset();
  return second;
}

Rendering render_in_two_media(Renderer& renderer, Scene const& scene, RenderPlan const& plan,
                              Particles const& particles, ParticleLight light, RenderImages images) {
  RenderImages const lit = images == RenderImages::no ? RenderImages::no : RenderImages::yes;
  Rendering all = renderer.render_particles(select_first_pulse(scene), plan, particles, light, lit);
  Rendering const later = renderer.render_particles(select_second_pulse(scene), plan, particles, light, lit);
  GroundTruth& truth = all.truth;
  truth.displacement_px = displacements(truth, later.truth);
  truth.displacement_std_px = later.truth.displacement_std_px;
  double const error = lit == RenderImages::no ? not_a_number : standard_error(renderer, scene, plan, particles);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    truth.flux[i].y = later.truth.flux[i].y;
    truth.rays[i][1] = later.truth.rays[i][1];
    truth.displacement_error_px[i] = {error, error};
  }
  all.statuses[1] = later.statuses[1];
  all.rays += later.rays;
  all.light.flow = later.light.flow;
  if (images == RenderImages::in_place) all.store_light_in_place();
  all.pupil_margin = std::max(all.pupil_margin, later.pupil_margin);
  return all;
}

}  // namespace gladstone::inline scene
