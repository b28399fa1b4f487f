#pragma once

#include <span>
#include <vector>

#include "render/base/vec.h"

namespace gladstone::inline tracking {

/// Criterion of find_outliers().
struct OutlierTest {
  double threshold = 3;     ///< largest normalised median residual [1]
  double epsilon_px = 0.1;  ///< noise level that is added to the spread of the neighbours [px]
};

/// Finds outliers among scattered vectors by the normalised median test of Westerweel & Scarano, Exp. Fluids 39 (2005)
/// 1096, with the eight nearest vectors as neighbours. Duncan et al., Meas. Sci. Technol. 21 (2010) 057002, also weight
/// the neighbours by distance. If gradients are large, pass the deviations from a predictor instead of the
/// displacements.
/// @param positions  positions of the vectors [px]
/// @param values     displacements, or their deviations from a predictor [px]; vectors that are not finite are ignored
/// @return 1 for outliers, else 0; vectors with fewer than three neighbours are not judged (0)
std::vector<char> find_outliers(std::span<Vec2d const> positions, std::span<Vec2d const> values,
                                OutlierTest const& test = {});

}  // namespace gladstone::inline tracking
