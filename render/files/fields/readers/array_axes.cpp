#include "render/files/fields/readers/array_axes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace gladstone::inline files {

std::string shape_text(ArrayShape const& shape) { return fmt::format("[{}]", fmt::join(shape, ", ")); }

std::optional<ArrayAxes> find_axes(ArrayShape const& shape, int values) {
  ArrayAxes axes;
  axes.shape = shape;
  for (std::size_t axis = 0; axis < shape.size(); ++axis) axes.spatial.push_back(axis);
  if (values > 1) {
    auto const count = static_cast<std::size_t>(values);
    if (shape.size() < 3 || (shape.back() != count && shape.front() != count)) return std::nullopt;
    axes.component = shape.back() == count ? shape.size() - 1 : 0;
    std::erase(axes.spatial, *axes.component);
  } else if (shape.size() > 3 &&
             (may_be_components(shape.back()) || (may_be_components(shape.front()) && shape.back() != 1))) {
    return std::nullopt;  // components of a vector, not an axis of two or three nodes
  }
  // Drop axes of length one until three remain: the last (one value per node) first, then from the front (one time).
  while (axes.spatial.size() > 3) {
    auto const single = [&shape](std::size_t axis) { return shape[axis] == 1; };
    auto const found = single(axes.spatial.back()) ? axes.spatial.end() - 1
                                                   : std::find_if(axes.spatial.begin(), axes.spatial.end(), single);
    if (found == axes.spatial.end()) return std::nullopt;
    axes.spatial.erase(found);
  }
  if (axes.spatial.size() < 2) return std::nullopt;
  return axes;
}

bool may_be_components(std::size_t size) { return size == 2 || size == 3; }

}  // namespace gladstone::inline files
