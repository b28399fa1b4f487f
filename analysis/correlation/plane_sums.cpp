#include "analysis/correlation/plane_sums.h"

namespace gladstone::inline correlation {

PlaneSums::PlaneSums(std::size_t windows, int radius) {
  std::size_t const side = static_cast<std::size_t>(LanePlane(radius).side());
  plane_size_ = side * side;
  sums_.resize(windows * plane_size_);
  measured_.resize(windows);
}

void PlaneSums::add(std::size_t first, int count, LanePlane& plane, WindowCorrelation::Outcome* outcome) {
  int const reach = plane.reach();
  for (int lane = 0; lane < count; ++lane) {
    std::size_t const window = first + static_cast<std::size_t>(lane);
    bool const measured = outcome[lane] == WindowCorrelation::Outcome::measured;
    if (measured) ++measured_[window];
    if (measured_[window] == 0) continue;
    outcome[lane] = WindowCorrelation::Outcome::measured;
    float const part = 1.0f / static_cast<float>(measured_[window]);
    float* sum = sums_.data() + window * plane_size_;
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx, ++sum) {
        if (measured) *sum += plane(dx, dy)[lane];
        plane(dx, dy)[lane] = part * *sum;
      }
  }
}

}  // namespace gladstone::inline correlation
