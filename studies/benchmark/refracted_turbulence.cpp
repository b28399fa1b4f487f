#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "analysis/correlation/window_deformation.h"
#include "render/base/units.h"
#include "render/sensor/detector.h"
#include "studies/benchmark/benchmark_cases.h"
#include "studies/case/shared_folder.h"
#include "studies/case/write_case.h"
#include "studies/compare/compare.h"

namespace gladstone::inline benchmarks {
namespace {

/// Spacing of the truth: a seventh of the light cone's width at the medium, in image coordinates.
constexpr int lattice_px = 4;

CaseSetup setup_of(std::uint64_t seed) {
  std::string const shared = shared_folder();
  return load_case_setup(
      shared + "/studies/cases/table1.toml",
      {fmt::format("medium.field.file=\"{}/data/fields/hbdt512_kepeak_slice.h5\"", shared),
       "medium.field.spacing_mm=[0.519, 0.519, 0.519]", "medium.thickness_mm=40", "render.rays_per_dot=256",
       "render.method=\"focused_dots\"", fmt::format("target.seed={}", seed)});
}

}  // namespace

RefractedTurbulence::RefractedTurbulence(std::uint64_t seed, Renderer& renderer)
    : renderer_(renderer),
      loaded_(setup_of(seed)),
      prepared_(prepare_case(loaded_)),
      rendered_(render_case(prepared_, renderer, RenderTheory::no)) {}

ParticlePair RefractedTurbulence::frames(double noise, std::uint64_t noise_seed) const {
  constexpr double background = 25.5, peak = 153.0;  // same values as in render_particle_pair()
  Detector const detector(prepared_.scene.setup.camera, rendered_.exposure_e);
  std::unique_ptr<StoredFrames const> const ideal = rendered_.rendering->in_place->ideal(detector);
  ParticlePair pair{{ideal->reference(), ideal->flow()}};
  double const brightest = std::max(*std::max_element(pair.reference.begin(), pair.reference.end()),
                                    *std::max_element(pair.flow.begin(), pair.flow.end()));
  std::mt19937_64 bits(noise_seed);
  auto const uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
  for (Image<double>* image : {&pair.reference, &pair.flow})
    for (double& value : *image) {
      double const radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));  // Box-Muller transform
      value = background + peak * (value / brightest + noise * radius * std::cos(2.0 * pi * uniform()));
      value = std::clamp(std::round(value), 0.0, 255.0);
    }
  GroundTruth const& dots = rendered_.rendering->truth;
  for (std::size_t i = 0; i < dots.size(); ++i) {
    if (!std::isfinite(dots.displacement_px[i].x) || !std::isfinite(dots.reference_px[i].x)) continue;
    pair.dot_reference_px.push_back(dots.reference_px[i]);
    pair.dot_displacement_px.push_back(dots.displacement_px[i]);
    pair.dot_light.push_back(std::sqrt(std::max(0.0, dots.flux[i].x * dots.flux[i].y)));
  }
  return pair;
}

DisplacementAt RefractedTurbulence::truth() const {
  InterrogationGrid const grid = make_interrogation_grid(pixels, pixels, 2 * lattice_px, 0.5);
  std::vector<Vec2d> centres(grid.size());
  for (std::size_t i = 0; i < centres.size(); ++i) centres[i] = grid.centre(i);
  GroundTruth const points =
      truth_at_points(prepared_.scene, prepared_.plan, renderer_, centres, TruthAt::mid_position, RenderTheory::no);
  auto const map = std::make_shared<DensePredictor const>(grid, points.displacement_px, pixels, pixels);
  return [map](Vec2d p) { return map->at(p); };
}

}  // namespace gladstone::inline benchmarks
