#include "render/rays/sample_images.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "render/base/random.h"
#include "render/rays/rays_renderer.h"
#include "render/scene/source_sample.h"
#include "render/scene/two_media.h"

namespace gladstone {
namespace {

constexpr std::size_t sample_sources = 96;

/// Removes the light of all particles except some.
void darken_others(Particles& particles, std::vector<std::size_t> const& some) {
  std::vector<char> kept(particles.size(), 0);
  for (std::size_t const i : some) kept[i] = 1;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] == 0) particles.photons[0][i] = particles.photons[1][i] = 0;
  }
}

/// Returns the mean squared difference of two images of a sample over the lit pixels of the image of all sources.
/// With a pixels of the sample lit among A, the image of n times as many sources has A (1 - exp(-n a / A)) lit pixels
/// if they are placed at random, and the squares add up.
double mean_square(Image<double> const& one, Image<double> const& other, double level, double share) {
  double square = 0, lit = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    double const a = one.data()[i], b = other.data()[i];
    if (a + b < 2 * level) continue;
    square += (a - b) * (a - b);
    ++lit;
  }
  auto const area = static_cast<double>(one.size());
  return share * square / (-std::expm1(-share * lit / area) * area);
}

}  // namespace

SampleImages render_sample(Scene scene) {
  std::vector<std::size_t> const in_view = sources_in_view(scene), some = choose_sample(in_view, sample_sources);
  SampleImages sample;
  if (some.empty()) return {{Image<double>(1, 1), Image<double>(1, 1)}};
  sample.share = static_cast<double>(in_view.size()) / static_cast<double>(some.size());
  if (scene.setup.piv) {
    darken_others(scene.particles, some);
    sample.light =
        RaysRenderer().render_particles(scene, scene.particles, ParticleLight::scattered, RenderImages::yes).light;
  } else {
    scene.dots = select_dots(scene.dots, some);
    scene.setup.target.polarity = Polarity::bright;
    sample.light = RaysRenderer().render(scene, scene.dots, RenderImages::yes, RenderTheory::no).light;
  }
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

double measure_image_error(Scene const& scene, double level) {
  if (scene.second_medium) {
    return std::fmax(measure_image_error(select_first_pulse(scene), level),
                     measure_image_error(select_second_pulse(scene), level));
  }
  constexpr double finer = 4;
  Scene one = scene, other = scene;
  one.setup.render.seed = repeat_seed(scene.setup.render.seed, 1000003u);
  other.setup.render.seed = repeat_seed(scene.setup.render.seed, 1000004u);
  bool const ruled = scene.setup.piv && scene.adaptive_criteria;
  if (ruled) {
    other.adaptive_criteria->level /= finer;
    other.adaptive_criteria->brightest_at *= finer;
  }
  SampleImages const a = render_sample(std::move(one)), b = render_sample(std::move(other));
  double worse = std::numeric_limits<double>::quiet_NaN();
  for (auto const frame : {&LightPair::reference, &LightPair::flow}) {
    worse = std::fmax(worse, mean_square(a.light.*frame, b.light.*frame, level, a.share));
  }
  return std::sqrt(ruled ? worse : worse / 2) / level;
}

}  // namespace gladstone
