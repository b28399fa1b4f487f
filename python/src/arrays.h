#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/base/image.h"
#include "render/base/image_samples.h"
#include "render/base/vec.h"

namespace gladstone::python {

namespace nb = nanobind;

/// Images that any array library passes through the buffer protocol or the DLPack protocol, in host or GPU memory.
using ImageArray = nb::ndarray<nb::ro, nb::ndim<2>, nb::device::cpu>;
using GpuImageArray = nb::ndarray<nb::ro, nb::ndim<2>, nb::device::cuda>;
using NumberArray = nb::ndarray<double const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Checks an image and completes its description by the type of its samples. @param samples address, size and steps of
/// the image
/// @throws DataError for images without pixels, and for samples of another type than integers of 8 to 64 bits and
/// floats of 32 or 64 bits
ImageSamples described_image(ImageSamples samples, nb::dlpack::dtype type, std::string const& name);
template <class Array>
ImageSamples image_samples(Array const& array, std::string const& name) {
  return described_image({.first = array.data(),
                          .columns = static_cast<std::int64_t>(array.shape(1)),
                          .rows = static_cast<std::int64_t>(array.shape(0)),
                          .column_step = array.stride(1),
                          .row_step = array.stride(0)},
                         array.dtype(), name);
}
/// Returns the grey levels of an image in host memory.
Image<double> read_samples(ImageSamples const& samples);

/// Returns a read-only NumPy view of memory that belongs to `owner`; the view keeps `owner` alive.
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
