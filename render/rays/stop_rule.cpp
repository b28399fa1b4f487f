#include "render/rays/stop_rule.h"

#include <cmath>

#include "render/base/gauss_legendre.h"

namespace gladstone::inline rays {

StopRule::StopRule(std::uint64_t rays) {
  int const rings = static_cast<int>(std::lround(std::sqrt(static_cast<double>(rays) / 4)));
  GLADSTONE_EXPECTS(rings > 0 && 4 * static_cast<std::uint64_t>(rings) * static_cast<std::uint64_t>(rings) == rays);
  GaussLegendre const gauss(rings);
  for (std::size_t ring = 0; ring < gauss.node.size(); ++ring) {
    radius2_.push_back(0.5 * (gauss.node[ring] + 1));
    share_.push_back(0.5 * rings * gauss.weight[ring]);
  }
}

}  // namespace gladstone::inline rays
