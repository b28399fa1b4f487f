#pragma once

#include <span>
#include <vector>

#include "render/base/vec.h"

namespace gladstone::tracking {

/// Criterion of find_outliers().
struct OutlierTest {
  double threshold = 3;        ///< largest normalised residual of each component [1]
  double epsilon_px = 0.1;     ///< noise level that is added to the spread of the neighbours [px]
  std::size_t neighbours = 8;  ///< number of nearest vectors with which a vector is compared
};

/// Finds outliers among scattered vectors by the normalised median test of Westerweel & Scarano, Exp. Fluids 39 (2005)
/// 1096, with the nearest vectors as neighbours as in Duncan et al., Meas. Sci. Technol. 21 (2010) 057002 (without
/// their weights by distance). Before the test, the neighbours' least-squares plane is not subtracted: pass deviations
/// from a predictor where gradients are large.
/// @param positions  [px]
/// @param values     displacements, or their deviations from a predictor [px]; vectors that are not finite are ignored
/// @return whether each vector is an outlier; false if it has fewer than three neighbours
std::vector<char> find_outliers(std::span<Vec2d const> positions, std::span<Vec2d const> values,
                                OutlierTest const& test = {});

}  // namespace gladstone::tracking
