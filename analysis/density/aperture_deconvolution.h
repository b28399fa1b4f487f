#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "analysis/density/aperture_transfer.h"
#include "analysis/density/gradient_map.h"

namespace gladstone::inline density {

/// Linear filter that compensates the averaging over the aperture cone in an integrated density, with a Wiener gain
///   G(q) = H (1 + nu) / (H^2 + nu)
/// with the transfer function H of compute_aperture_transfer(). G(0) = 1, the largest gain is (1 + nu)/(2 sqrt(nu)),
/// and the amplitudes of waves near and beyond the first zero of H are not restored. The filter is applied by a cosine
/// transform, which continues the density by reflection at the borders; holes are filled by a harmonic function
/// (Laplace equation). The result is therefore less accurate within one cone diameter of borders and holes.
///
/// The deconvolution amplifies noise; for its uncertainty, pass apply() as the filter of propagate_uncertainty().
class ApertureDeconvolution {
 public:
  /// @param determined    nodes with a density [grid.size()]: 1 or 0
  /// @param maximum_gain  largest amplification of any wave, above 1 [1]
  /// @throws SetupError   if the gain is not above 1, or a length of the cone is not positive and finite
  /// @throws DataError    if no node has a density
  ApertureDeconvolution(PlaneGrid const& grid, std::span<std::uint8_t const> determined, ApertureCone const& cone,
                        double maximum_gain);
  ~ApertureDeconvolution();
  ApertureDeconvolution(ApertureDeconvolution&&) noexcept;
  ApertureDeconvolution& operator=(ApertureDeconvolution&&) noexcept;

  /// Filters a density, or an error of the density.
  /// @param density  density or its error [grid.size()]; ignored at nodes that are not determined
  /// @return filtered values [grid.size()]; NaN at nodes where the argument is NaN, 0 at other nodes that are not
  ///         determined
  std::vector<double> apply(std::span<double const> density) const;

  double wiener_parameter() const;  ///< Wiener parameter nu [1]
  /// Returns the factor by which the filter amplifies white noise: rms of the gain over all waves of the grid [1]. The
  /// noise of an integrated density consists mostly of long waves, which are amplified less.
  double white_noise_gain() const;

 private:
  struct Filter;
  std::unique_ptr<Filter const> filter_;
};

}  // namespace gladstone::inline density
