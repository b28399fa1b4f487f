#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gladstone::inline files {

/// Number of elements along each axis of an array, slowest first.
using ArrayShape = std::vector<std::size_t>;

/// Returns the shape as text: "[16, 20, 24]".
std::string shape_text(ArrayShape const& shape);

/// Shape of an array that holds a field, and roles of its axes.
struct ArrayAxes {
  ArrayShape shape;
  std::vector<std::size_t> spatial;      ///< indices of the two or three spatial axes, slowest first
  std::optional<std::size_t> component;  ///< index of the axis of velocity components

  /// Number of spatial axes, 2 or 3.
  std::size_t rank() const { return spatial.size(); }
  /// Index in the array of a spatial axis, which is counted from the fastest.
  std::size_t number(std::size_t axis) const { return spatial[rank() - 1 - axis]; }
  /// Number of nodes along a spatial axis, which is counted from the fastest.
  std::size_t length(std::size_t axis) const { return shape[number(axis)]; }
};

/// Determines the axes of an array with `values` numbers per node; nullopt if the shape is not a field.
std::optional<ArrayAxes> find_axes(ArrayShape const& shape, int values);

/// Returns true if an axis has the length of two- or three-component vectors.
bool may_be_components(std::size_t size);

}  // namespace gladstone::inline files
