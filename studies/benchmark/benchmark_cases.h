#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "render/base/image.h"
#include "studies/benchmark/particle_pair.h"
#include "studies/case.h"

namespace gladstone {

/// Displacement at a place, both in px: what symmetric schemes measure there.
using DisplacementAt = std::function<Vec2d(Vec2d position_px)>;

/// A uniform displacement.
DisplacementAt uniform_flow(Vec2d displacement_px);
/// u = rate (y - middle): a flow that shears about the middle of the image.
DisplacementAt shear_flow(double rate, int pixels);
/// Lamb & Oseen's vortex about the middle of the image, at most 5 px at 1.12 times its radius.
DisplacementAt vortex_flow(double radius_px, int pixels);
/// u = sin(2 pi y/length), v = sin(2 pi x/length) [px].
DisplacementAt sine_flow(double length_px);

/// One published case: two frames of 8-bit grey levels whose displacement is known everywhere.
struct BenchmarkCase {
  std::string name;
  std::string what;            ///< in words
  ParticleSettings particles;  ///< of ideal images; of the refracted case its size, seed and noise alone
  DisplacementAt flow = {};    ///< empty: rendered by rays through turbulence
  bool refracted() const { return !flow; }
};

/// Every case, in their order, all of 1024 x 1024 px but turbulence: the one list. Seeds are those of the cases'
/// names, so that cases neither share particles nor depend on one another.
std::vector<BenchmarkCase> const& benchmark_cases();

/// Turbulence as a camera sees it: dots through the field of data/fields, traced by rays (studies/cases/table1.toml,
/// a layer four times as deep at the earlier instant, 64 nodes across the view).
class RefractedTurbulence {
 public:
  static constexpr int pixels = 512;  ///< along either axis

  /// Renders a pair whose dots have this seed. @param renderer of any device
  RefractedTurbulence(std::uint64_t seed, Renderer& renderer);

  /// The frames in whole grey levels of 8 bits, with noise of this standard deviation over the brightest dot's peak.
  ParticlePair frames(double noise, std::uint64_t noise_seed) const;
  /// That of rays at points on a lattice, by cubic convolution between: the light cone passes nothing as fine as the
  /// lattice. It does not depend on the dots.
  DisplacementAt truth() const;
  /// The setup with all defaults, which renders the frames before they were made 8-bit and noisy.
  std::string resolved() const { return loaded_.document.resolved(); }

 private:
  Renderer& renderer_;
  CaseSetup loaded_;
  PreparedCase prepared_;
  RenderedCase rendered_;
};

}  // namespace gladstone
