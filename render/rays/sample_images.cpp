#include "render/rays/sample_images.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "render/base/parallel.h"
#include "render/base/random.h"
#include "render/rays/particle_tracer.h"
#include "render/rays/rays_renderer.h"
#include "render/rays/trace_particles.h"
#include "render/scene/source_sample.h"
#include "render/scene/spot.h"
#include "render/scene/two_media.h"

namespace gladstone::inline rays {
namespace {

constexpr std::size_t sample_sources = 96;

/// Renders some particles of a PIV scene.
/// @return whether the next finer rule was used
bool render_particles(Scene const& scene, RenderPlan const& plan, std::vector<std::size_t> const& some, SampleRays rays,
                      FramePair<double>& light) {
  std::optional<AiryTable> airy;
  ParticleLaunches const launches(scene, plan, make_spot(scene, airy), RenderImages::yes);
  bool const next_rule = rays == SampleRays::next_rule && launches.ladder[0].rule.view();
  int const columns = scene.setup.camera.columns, rows = scene.setup.camera.rows;
  LightImage reference(columns, rows), flow(columns, rows);
  LightImage* const images[frame_count] = {&reference, &flow};
  LightImage* const none[frame_count] = {};
  double const light_per_photon = 1 / scene.photon_unit;
  with_particles(scene, scene.particles, ParticleLight::scattered, [&](auto const& pulses, auto const& medium) {
    parallel_chunks(some.size(), 4, [&](std::size_t begin, std::size_t end) {
      ParticleTracer tracer(launches, pulses, medium, true);
      for (std::size_t i = begin; i < end; ++i) {
        tracer.trace(some[i], next_rule ? none : images, light_per_photon);
        if (next_rule) tracer.trace(some[i], images, light_per_photon, tracer.step() + 1);
      }
    });
  });
  light = {reference.to_light(), flow.to_light()};
  return next_rule;
}

/// Estimates the mean squared difference of two images of all sources over their lit pixels, from images of a sample.
/// If the sample lights a of A pixels, a pixel is dark with probability 1 - a / A. With n times as many sources at
/// random positions, this probability is (1 - a / A)^n, so that A (1 - (1 - a / A)^n) pixels are lit. The sum of the
/// squared differences is n times that of the sample.
/// @param share  n
double mean_square(Image<double> const& one, Image<double> const& other, double level, double share) {
  double square = 0, lit = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    double const a = one.data()[i], b = other.data()[i];
    if (a + b < 2 * level) continue;
    square += (a - b) * (a - b);
    ++lit;
  }
  auto const area = static_cast<double>(one.size());
  return share * square / (-std::expm1(share * std::log1p(-lit / area)) * area);
}

}  // namespace

SampleImages render_sample(Scene const& scene, RenderPlan const& plan, std::vector<std::size_t> const& sources,
                           SampleRays rays) {
  std::vector<std::size_t> const in_view = sources_in_view(scene, sources),
                                 some = choose_sample(in_view, sample_sources);
  SampleImages sample;
  if (some.empty()) return {{Image<double>(1, 1), Image<double>(1, 1)}};
  sample.share = static_cast<double>(in_view.size()) / static_cast<double>(some.size());
  if (!scene.setup.experiment().sources.on_target) {
    sample.next_rule = render_particles(scene, plan, some, rays, sample.light);
    return sample;
  }
  RenderPlan bright = plan;
  bright.polarity = Polarity::bright;
  sample.light =
      RaysRenderer().render(scene, bright, select_dots(scene.dots, some), RenderImages::yes, RenderTheory::no).light;
  return sample;
}

double brightest_pixel(SampleImages const& sample) {
  double brightest = 0;
  for (Image<double> const* image : {&sample.light.reference, &sample.light.flow}) {
    double sum = 0, squares = 0;
    for (double const light : *image) {
      brightest = std::max(brightest, light);
      sum += light;
      squares += light * light;
    }
    auto const area = static_cast<double>(image->size());
    double const mean = sum / area, variance = squares / area - mean * mean;
    brightest = std::max(brightest, sample.share * mean + 3 * std::sqrt(sample.share * variance));
  }
  return brightest;
}

double measure_image_error(Scene const& scene, RenderPlan const& plan, double level,
                           std::vector<std::size_t> const& sources) {
  if (scene.second_medium) {
    return std::fmax(measure_image_error(select_first_pulse(scene), plan, level, sources),
                     measure_image_error(select_second_pulse(scene), plan, level, sources));
  }
  RenderPlan one = plan, other = plan;
  one.seed = repeat_seed(plan.seed, 1000003u);
  other.seed = repeat_seed(plan.seed, 1000004u);
  SampleImages const a = render_sample(scene, one, sources),
                     b = render_sample(scene, other, sources, SampleRays::next_rule);
  double worse = std::numeric_limits<double>::quiet_NaN();
  for (auto const frame : {&FramePair<double>::reference, &FramePair<double>::flow}) {
    worse = std::fmax(worse, mean_square(a.light.*frame, b.light.*frame, level, a.share));
  }
  return std::sqrt(b.next_rule ? worse : worse / 2) / level;
}

}  // namespace gladstone::inline rays
