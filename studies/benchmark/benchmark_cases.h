#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/base/image.h"
#include "studies/benchmark/particle_pair.h"
#include "studies/case/case.h"
#include "studies/case/write_case.h"

namespace gladstone::inline benchmarks {

/// Displacement [px] as a function of position [px], in the central definition that symmetric schemes measure.
using DisplacementAt = std::function<Vec2d(Vec2d position_px)>;

/// Returns a uniform displacement.
DisplacementAt uniform_flow(Vec2d displacement_px);
/// Returns the shear u = rate (y - y_c), where y_c is the image's centre.
DisplacementAt shear_flow(double rate, int pixels);
/// Returns a Lamb-Oseen vortex at the image's centre, with a maximum displacement of 5 px at 1.12 times radius_px.
DisplacementAt vortex_flow(double radius_px, int pixels);
/// Returns u = sin(2 pi y/length), v = sin(2 pi x/length) [px].
DisplacementAt sine_flow(double length_px);

/// Random smooth displacement: six plane waves with random phases, random directions of propagation and of
/// displacement, and wavelengths of 1 to 2 times 2 pi size_px. Their amplitudes are equal and scaled to the peak
/// gradient. A single wave of wavelength 2 pi size_px with this gradient has an amplitude of size_px times the
/// gradient.
struct RandomWaves {
  double size_px = 20.0;        ///< size of the features: 1 over the largest wavenumber [px]
  double peak_gradient = 0.25;  ///< spectral norm of the displacement gradient at its maximum on the image [px/px]
  std::uint64_t seed = 1;
};
DisplacementAt random_flow(RandomWaves const& waves, int pixels);

/// Displacement step: the two sides of an edge through the image's centre slide along it, by half of `height_px` each
/// in opposite directions. The edge is inclined by 0.1 against the columns, so that vectors on any grid sample the
/// response at all distances from it (as the slanted edge of ISO 12233 does for cameras).
DisplacementAt step_flow(double height_px, int pixels);
/// Width of the response of vectors to step_flow(): distance across the edge in which their mean component along it
/// rises from 10 to 90 % of the step [px]. Means are formed in intervals of 1 px. NaN if the response does not reach
/// these levels within 64 px of the edge.
double step_width_px(DisplacementField const& field, double height_px, int pixels);

/// Published benchmark case: two 8-bit frames with a displacement that is known everywhere.
struct BenchmarkCase {
  std::string name;
  std::string what;            ///< description for the user
  ParticleSettings particles;  ///< settings of synthetic images; for the refracted case, only size, seed and noise
                               ///< apply
  DisplacementAt flow = {};    ///< true displacement; empty: images ray-traced through turbulence
  bool refracted() const { return !flow; }
};

/// Case of step_flow() and height of its step [px]: below the particle diameter, so that windows on the edge have one
/// correlation peak.
inline constexpr char const* step_case = "step";
inline constexpr double step_case_height_px = 2.0;

/// Returns all cases in their order, of 1024 x 1024 px except turbulence. The seed of a case is derived from its name,
/// so that cases share no particles and are independent of each other.
std::vector<BenchmarkCase> const& benchmark_cases();

/// BOS images of turbulence: dots ray-traced through a field of data/fields (set-up of studies/cases/table1.toml, with
/// a layer four times as deep at the earlier instant and 64 nodes across the field of view).
class RefractedTurbulence {
 public:
  static constexpr int pixels = 512;  ///< image size along either axis

  /// Renders an image pair. @param seed of the random dot pattern @param renderer on any device
  RefractedTurbulence(std::uint64_t seed, Renderer& renderer);

  /// Returns 8-bit frames with noise.
  /// @param noise  standard deviation relative to the peak of the brightest dot [1]
  ParticlePair frames(double noise, std::uint64_t noise_seed) const;
  /// Returns the true displacement: ray-traced at the points of a lattice and interpolated by cubic convolution. The
  /// lattice is finer than the smallest structures that pass the averaging by the light cone. Independent of the dots.
  DisplacementAt truth() const;
  /// Returns the setup with all defaults; it describes the frames before quantisation to 8 bits and noise.
  std::string resolved() const { return loaded_.document.resolved(); }

 private:
  Renderer& renderer_;
  CaseSetup loaded_;
  PreparedCase prepared_;
  RenderedCase rendered_;
};

}  // namespace gladstone::inline benchmarks
