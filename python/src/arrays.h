#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <string>
#include <vector>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone::python {

namespace nb = nanobind;

/// Image given by any array library through the buffer or the DLPack protocol.
using ImageArray = nb::ndarray<nb::ro, nb::ndim<2>, nb::device::cpu>;
using NumberArray = nb::ndarray<double const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Image in the form that the correlator takes, and the number of bits of its samples.
struct GivenImage {
  Image<double> image;
  int sample_bits = 0;
};
/// Converts an image [rows, columns] of integers or floats. @throws DataError for samples of another type
GivenImage read_array(ImageArray const& array, std::string const& name);

/// Returns a read-only NumPy view of memory that `owner` keeps alive.
template <class T>
nb::object view_of(T const* data, std::initializer_list<std::size_t> shape, nb::handle owner) {
  return nb::cast(nb::ndarray<nb::numpy, T const>(data, shape.size(), shape.begin(), owner));
}

static_assert(sizeof(Vec2d) == 2 * sizeof(double) && sizeof(Vec3d) == 3 * sizeof(double));

/// Returns a read-only view [count, 2] or [count, 3]; None for an empty vector.
inline nb::object view_of(std::vector<Vec2d> const& values, nb::handle owner) {
  if (values.empty()) return nb::none();
  return view_of(&values.front().x, {values.size(), 2}, owner);
}
inline nb::object view_of(std::vector<Vec3d> const& values, nb::handle owner) {
  if (values.empty()) return nb::none();
  return view_of(&values.front().x, {values.size(), 3}, owner);
}
template <class T>
nb::object view_of(std::vector<T> const& values, nb::handle owner) {
  if (values.empty()) return nb::none();
  return view_of(values.data(), {values.size()}, owner);
}

/// Moves a vector into a NumPy array of the given shape, without a copy.
template <class T>
nb::object array_of(std::vector<T> values, std::vector<std::size_t> const& shape) {
  auto* const kept = new std::vector<T>(std::move(values));
  nb::capsule const owner(kept, [](void* vector) noexcept { delete static_cast<std::vector<T>*>(vector); });
  return nb::cast(nb::ndarray<nb::numpy, T>(kept->data(), shape.size(), shape.data(), owner));
}

}  // namespace gladstone::python
