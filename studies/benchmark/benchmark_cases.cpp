#include "studies/benchmark/benchmark_cases.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "render/base/contracts.h"
#include "render/base/units.h"

namespace gladstone {
namespace {

constexpr int case_pixels = 1024;
constexpr double per_window = 1.0 / 1024.0;  ///< density of one particle per 32 x 32 px [1/px^2]

/// Derives a seed from a name: sum of the letters weighted by their positions.
std::uint64_t seed_of(std::string const& name) {
  std::uint64_t seed = 500000;
  for (std::size_t i = 0; i < name.size(); ++i) seed += (i + 1) * static_cast<unsigned char>(name[i]);
  return seed;
}

std::vector<BenchmarkCase> make_cases() {
  std::vector<BenchmarkCase> cases;
  auto const add = [&](std::string const& name, std::string const& what, DisplacementAt flow,
                       ParticleSettings particles = {}) {
    int const size = flow ? case_pixels : RefractedTurbulence::pixels;
    particles.columns = particles.rows = size;
    particles.seed = seed_of(name);
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

std::vector<BenchmarkCase> const& benchmark_cases() {
  static std::vector<BenchmarkCase> const cases = make_cases();
  return cases;
}

}  // namespace gladstone
