#include "analysis/tomography/line_projector.h"

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone::inline tomography {
namespace {

constexpr std::size_t lines_per_task = 256;
constexpr int planes_per_task = 4;

std::size_t count_nodes(VolumeShape const& shape) {
  return static_cast<std::size_t>(shape.nodes[0]) * static_cast<std::size_t>(shape.nodes[1]) *
         static_cast<std::size_t>(shape.nodes[2]);
}

}  // namespace

LineProjector::LineProjector(RegularGrid const& grid, std::span<SightLine const> lines)
    : shape_(VolumeShape::of(grid)), lines_(lines), row_sums_(lines.size()) {
  GLADSTONE_EXPECTS(*std::min_element(grid.nodes.begin(), grid.nodes.end()) >= 2);
  Vec3d crossed{};
  for (SightLine const& line : lines)
    for (int axis = 0; axis < 3; ++axis) crossed[axis] += std::abs(line.direction[axis]);
  slab_axis_ = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (crossed[axis] < crossed[slab_axis_]) slab_axis_ = axis;
  parallel_chunks(lines.size(), lines_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) row_sums_[i] = LineProjection::row_sum(shape_, lines_[i]);
  });
}

std::vector<double> LineProjector::project(std::span<double const> volume) const {
  GLADSTONE_EXPECTS(volume.size() == count_nodes(shape_));
  LineProjection const integrate{shape_, volume.data()};
  std::vector<double> projected(lines_.size());
  parallel_chunks(lines_.size(), lines_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) projected[i] = integrate(lines_[i]);
  });
  return projected;
}

void LineProjector::back_project(std::span<double const> values, std::vector<NodeSum>& sums) const {
  GLADSTONE_EXPECTS(values.size() == lines_.size());
  sums.assign(count_nodes(shape_), {});
  int const planes = shape_.nodes[slab_axis_];
  auto const slabs = static_cast<std::size_t>((planes + planes_per_task - 1) / planes_per_task);
  parallel_for(slabs, [&](std::size_t slab) {
    int const low = static_cast<int>(slab) * planes_per_task, high = std::min(low + planes_per_task, planes);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      double const value = values[i];
      if (!std::isfinite(value)) continue;
      visit_slab(shape_, lines_[i], slab_axis_, low, high,
                 [&](std::ptrdiff_t node, double weight) { sums[static_cast<std::size_t>(node)].add(weight, value); });
    }
  });
}

}  // namespace gladstone::inline tomography
