#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "analysis/density/gradient_map.h"
#include "analysis/density/line_differences.h"
#include "analysis/density/reference_density.h"
#include "analysis/density/regions.h"

namespace gladstone::inline density {

/// Treatment of a region without reference nodes, whose density is undetermined by a constant.
enum class UnreferencedRegions { error, leave_out };

struct IntegrationSettings {
  std::string method = "wls";            ///< one of integration_methods()
  EdgeRule rule = EdgeRule::four_point;  ///< treatment of region edges by methods that do not define one
  UnreferencedRegions unreferenced = UnreferencedRegions::error;
  /// Largest number of unknowns that is solved by sparse Cholesky factorisation; larger systems are solved by conjugate
  /// gradients.
  std::size_t direct_limit = 400'000;
};

/// Integration of a gradient map by least squares, prepared once for any number of right-hand sides. The reference
/// nodes have exactly the given density. At all other borders, including those of holes, the natural (Neumann)
/// condition applies: the normal derivative of the density equals the measured gradient. The error decreases with the
/// square of the spacing for EdgeRule::trapezoid. For EdgeRule::four_point, it decreases with the fourth power of the
/// spacing, and with the third power next to borders and holes.
class DensityIntegrator {
 public:
  /// @param map  gradient; without sigma, all equations have equal weights
  /// @throws DataError   see check_gradient_map(); also if the reference nodes are all masked, or if a region has no
  ///                     reference node and `unreferenced` is `error`
  /// @throws SetupError  if no reference node is given, a reference value is infinite, or the number of reference
  ///         values differs from the number of nodes
  DensityIntegrator(GradientMap const& map, ReferenceDensity const& reference,
                    IntegrationSettings const& settings = {});
  ~DensityIntegrator();
  DensityIntegrator(DensityIntegrator&&) noexcept;
  DensityIntegrator& operator=(DensityIntegrator&&) noexcept;

  PlaneGrid const& grid() const;
  std::vector<Region> const& regions() const;
  std::vector<int> const& region_labels() const;  ///< index of the region of every node; -1: invalid node [grid.size()]
  /// Returns 1 for nodes whose density is determined, including reference nodes, and 0 for other nodes [grid.size()].
  std::vector<std::uint8_t> const& determined() const;
  std::vector<std::uint8_t> const& reference_nodes() const;
  std::size_t unknowns() const;

  /// Integrates a gradient [grid.size()] with the reference density. NaN at nodes without a determined density.
  std::vector<double> integrate(std::span<Vec2d const> gradient) const;
  /// Integrates an error of the gradient, with zero density at the reference nodes. The result is zero at undetermined
  /// nodes.
  std::vector<double> integrate_error(std::span<Vec2d const> gradient_error) const;
  /// Computes the derivative of the density at one node with respect to every gradient component [m], [grid.size()].
  /// @pre the node is determined
  std::vector<Vec2d> compute_sensitivity(std::size_t node) const;

 private:
  struct System;
  std::unique_ptr<System const> system_;
};

}  // namespace gladstone::inline density
