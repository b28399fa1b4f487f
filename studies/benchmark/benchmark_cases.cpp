#include "studies/benchmark/benchmark_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <mutex>
#include <random>
#include <utility>

#include "render/base/units.h"

namespace gladstone::inline benchmarks {
namespace {

constexpr int case_pixels = 1024;
constexpr double per_window = 1.0 / 1024.0;  ///< density of one particle per 32 x 32 px [1/px^2]

/// Derives a seed from a name: sum of the letters weighted by their positions.
std::uint64_t derive_seed(std::string const& name) {
  std::uint64_t seed = 500000;
  for (std::size_t i = 0; i < name.size(); ++i) seed += (i + 1) * static_cast<unsigned char>(name[i]);
  return seed;
}

/// Returns a flow that is made when it is first evaluated. Every command lists the cases, and normalising the random
/// flows takes 0.1 s.
DisplacementAt make_at_first_use(std::function<DisplacementAt()> make) {
  struct Made {
    std::once_flag once;
    DisplacementAt flow;
  };
  auto const made = std::make_shared<Made>();
  return [made, make = std::move(make)](Vec2d p) {
    std::call_once(made->once, [&] { made->flow = make(); });
    return made->flow(p);
  };
}

/// Adds six random fields with gradients from weak to steep, alternately with few and many particles.
template <class Add>
void add_random_flows(Add const& add) {
  struct Row {
    double size_px, peak_gradient;
  };
  constexpr Row rows[] = {{60.0, 0.1}, {40.0, 0.2}, {25.0, 0.3}, {20.0, 0.45}, {15.0, 0.6}, {12.0, 0.85}};
  for (int k = 0; k < 6; ++k) {
    std::string const name = fmt::format("kinematic_{}", k + 1);
    RandomWaves const waves{rows[k].size_px, rows[k].peak_gradient, derive_seed(name)};
    double const density = k % 2 == 0 ? 0.075 : 0.035;
    add(name,
        fmt::format("random waves with features of {} px, gradients up to {} px/px, {} particles per px",
                    rows[k].size_px, rows[k].peak_gradient, density),
        make_at_first_use([waves] { return random_flow(waves, case_pixels); }), {.particles_per_px = density});
  }
}

std::vector<BenchmarkCase> make_cases() {
  std::vector<BenchmarkCase> cases;
  auto const add = [&](std::string const& name, std::string const& what, DisplacementAt flow,
                       ParticleSettings particles = {}) {
    int const size = flow ? case_pixels : RefractedTurbulence::pixels;
    particles.columns = particles.rows = size;
    particles.seed = derive_seed(name);
    cases.push_back({name, what, particles, std::move(flow)});
  };
  DisplacementAt const uniform = uniform_flow({0.3, -0.3}), vortex = vortex_flow(100.0, case_pixels);
  add("uniform", "uniform displacement (0.3, -0.3) px", uniform);
  add("stretch", "u = 0.002 x, v = -0.002 y about the middle: all fractions of a pixel, for bias and peak locking",
      [](Vec2d p) {
        return Vec2d{0.002 * (p.x - 511.5), -0.002 * (p.y - 511.5)};
      });
  add("shear", "u = 0.02 y", shear_flow(0.02, case_pixels));
  add("vortex", "Lamb & Oseen's vortex, at most 5 px at 112 px from its middle", vortex);
  for (int const length : {256, 128, 64, 32})
    add(fmt::format("sine_{}", length), fmt::format("crossed sines of {} px and an amplitude of 1 px", length),
        sine_flow(length));
  for (int const noise : {1, 5, 10})
    add(fmt::format("noise_{}", noise), fmt::format("uniform displacement, noise of {} %", noise), uniform,
        {.noise = 0.01 * noise});
  add("vortex_noise_5", "the vortex, noise of 5 %", vortex, {.noise = 0.05});
  for (int const lost : {20, 40})
    add(fmt::format("loss_{}", lost), fmt::format("the vortex, {} % of the particles without a partner", lost), vortex,
        {.noise = 0.01, .lost = 0.01 * lost});
  for (int const tenths : {15, 45, 60})
    add(fmt::format("dots_{}.{}", tenths / 10, tenths % 10),
        fmt::format("uniform displacement, particle images of {:.1f} px, noise of 5 %", 0.1 * tenths), uniform,
        {.diameter_px = 0.1 * tenths, .noise = 0.05});
  for (int const density : {5, 40})
    add(fmt::format("density_{}", density),
        fmt::format("the vortex, {} particles in 32 x 32 px, noise of 5 %", density), vortex,
        {.particles_per_px = density * per_window, .noise = 0.05});
  add("light", "the vortex; frame B is half as bright, times 0.7 to 1.3 across the image; noise of 1 %", vortex,
      {.noise = 0.01, .flow_light = 0.5, .light_slope = 0.6});
  add("regular", "a square lattice of equal dots 8 px apart, displacement (1.3, -0.7) px, noise of 1 %",
      uniform_flow({1.3, -0.7}), {.noise = 0.01, .pitch_px = 8.0});
  add(step_case, fmt::format("displacement step of {} px along an oblique edge, for resolution", step_case_height_px),
      step_flow(step_case_height_px, case_pixels));
  add_random_flows(add);
  add("turbulence", "a BOS target seen through turbulence, ray-traced, noise of 1 %", {}, {.noise = 0.01});
  return cases;
}

}  // namespace

DisplacementAt uniform_flow(Vec2d displacement_px) {
  return [displacement_px](Vec2d) { return displacement_px; };
}

DisplacementAt shear_flow(double rate, int size) {
  double const middle = 0.5 * (size - 1);
  return [=](Vec2d p) { return Vec2d{rate * (p.y - middle), 0.0}; };
}

DisplacementAt vortex_flow(double radius_px, int size) {
  constexpr double most_px = 5.0, a = 1.2564312086261697;
  double const middle = 0.5 * (size - 1), strength = most_px * std::sqrt(a) * radius_px / (1.0 - std::exp(-a));
  return [=](Vec2d p) {
    Vec2d const r{p.x - middle, p.y - middle};
    double const square = std::max(dot(r, r), 1e-12);
    double const f = -strength * std::expm1(-square / (radius_px * radius_px)) / square;
    return Vec2d{-f * r.y, f * r.x};
  };
}

DisplacementAt sine_flow(double length_px) {
  return [=](Vec2d p) { return Vec2d{std::sin(2.0 * pi * p.y / length_px), std::sin(2.0 * pi * p.x / length_px)}; };
}

DisplacementAt random_flow(RandomWaves const& waves, int pixels) {
  struct Wave {
    Vec2d number, amplitude;  ///< wave vector [rad/px] and amplitude [px]
    double phase;             ///< [rad]
  };
  constexpr int count = 6, lattice_px = 2;
  std::mt19937_64 bits(waves.seed);
  auto const uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
  std::vector<Wave> all;
  for (int k = 0; k < count; ++k) {
    double const number = 1.0 / (waves.size_px * (1.0 + uniform()));
    double const along = 2.0 * pi * uniform(), across = 2.0 * pi * uniform();
    all.push_back({{number * std::cos(along), number * std::sin(along)},
                   {std::cos(across), std::sin(across)},
                   2.0 * pi * uniform()});
  }
  auto const norm_at = [&](Vec2d p) {
    Vec2d by_x, by_y;
    for (Wave const& wave : all) {
      double const slope = std::cos(dot(wave.number, p) + wave.phase);
      by_x += (slope * wave.number.x) * wave.amplitude;
      by_y += (slope * wave.number.y) * wave.amplitude;
    }
    // largest singular value of a 2 x 2 matrix
    double const half = 0.5 * (dot(by_x, by_x) + dot(by_y, by_y)), determinant = by_x.x * by_y.y - by_x.y * by_y.x;
    return std::sqrt(half + std::sqrt(std::max(0.0, half * half - determinant * determinant)));
  };
  double steepest = 0.0;
  for (int y = 0; y < pixels; y += lattice_px)
    for (int x = 0; x < pixels; x += lattice_px)
      steepest = std::max(steepest, norm_at({static_cast<double>(x), static_cast<double>(y)}));
  for (Wave& wave : all) wave.amplitude = (waves.peak_gradient / steepest) * wave.amplitude;
  return [all](Vec2d p) {
    Vec2d sum;
    for (Wave const& wave : all) sum += std::sin(dot(wave.number, p) + wave.phase) * wave.amplitude;
    return sum;
  };
}

namespace {

/// Edge of step_flow().
struct StepEdge {
  Vec2d along{0.1 / std::sqrt(1.01), 1.0 / std::sqrt(1.01)};
  Vec2d centre;

  explicit StepEdge(int pixels) : centre{0.5 * (pixels - 1), 0.5 * (pixels - 1)} {}
  double distance(Vec2d p) const { return (p.x - centre.x) * along.y - (p.y - centre.y) * along.x; }
};

}  // namespace

DisplacementAt step_flow(double height_px, int pixels) {
  StepEdge const edge(pixels);
  return [=](Vec2d p) { return std::copysign(0.5 * height_px, edge.distance(p)) * edge.along; };
}

double step_width_px(DisplacementField const& field, double height_px, int pixels) {
  constexpr int reach = 64;
  StepEdge const edge(pixels);
  std::vector<double> sum(2 * reach), count(2 * reach);
  for (std::size_t i = 0; i < field.size(); ++i) {
    double const cell = std::floor(edge.distance(field.position_px[i])) + reach;
    if (!field.counts(i) || !(cell >= 0.0 && cell < 2 * reach)) continue;
    sum[static_cast<std::size_t>(cell)] += 0.5 + dot(field.displacement_px[i], edge.along) / height_px;
    count[static_cast<std::size_t>(cell)] += 1.0;
  }
  // Compute mean positions and levels of the intervals that contain vectors, in ascending order of position.
  std::vector<Vec2d> response;
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (count[k] > 0.0) response.push_back({static_cast<double>(k) + 0.5 - reach, sum[k] / count[k]});
  auto const middle = std::find_if(response.begin(), response.end(), [](Vec2d r) { return r.y >= 0.5; });
  // Returns where the response crosses a level on one side of the middle.
  auto const crossing = [](auto const& begin, auto const& end, auto const& beyond, double level) {
    auto const found = std::find_if(begin, end, beyond);
    if (found == end || found == begin) return std::nan("");
    Vec2d const a = *(found - 1), b = *found;
    return a.x + (b.x - a.x) * (level - a.y) / (b.y - a.y);
  };
  if (middle == response.begin() || middle == response.end()) return std::nan("");
  double const low = crossing(
      std::make_reverse_iterator(middle + 1), response.rend(), [](Vec2d r) { return r.y <= 0.1; }, 0.1);
  double const high = crossing(
      middle - 1, response.end(), [](Vec2d r) { return r.y >= 0.9; }, 0.9);
  return high - low;
}

std::vector<BenchmarkCase> const& benchmark_cases() {
  static std::vector<BenchmarkCase> const cases = make_cases();
  return cases;
}

}  // namespace gladstone::inline benchmarks
