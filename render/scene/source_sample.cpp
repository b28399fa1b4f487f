#include "render/scene/source_sample.h"

#include <numeric>

namespace gladstone::inline scene {

std::vector<std::size_t> all_sources(Scene const& scene) {
  std::vector<std::size_t> all(scene.source_count());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

std::vector<std::size_t> sources_in_view(Scene const& scene, std::vector<std::size_t> const& sources) {
  std::vector<std::size_t> in_view;
  for (std::size_t const source : sources) {
    if (scene.source_in_view(source)) in_view.push_back(source);
  }
  if (in_view.empty() && !sources.empty()) in_view.push_back(sources.front());
  return in_view;
}

std::vector<std::size_t> choose_sample(std::vector<std::size_t> const& sources, std::size_t count) {
  if (sources.size() <= count) return sources;
  std::vector<std::size_t> sample;
  for (std::size_t i = 0; i < count; ++i) sample.push_back(sources[i * sources.size() / count]);
  return sample;
}

DotPattern select_dots(DotPattern const& all, std::vector<std::size_t> const& indices) {
  DotPattern some;
  some.half_size = all.half_size;
  some.shape = all.shape;
  for (std::size_t const i : indices) {
    some.centre.push_back(all.centre[i]);
    if (!all.radiance.empty()) some.radiance.push_back(all.radiance[i]);
  }
  return some;
}

}  // namespace gladstone::inline scene
