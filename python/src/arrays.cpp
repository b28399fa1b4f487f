#include "python/src/arrays.h"

#include "render/base/error.h"

namespace gladstone::python {
namespace {

template <class T>
Image<double> copied(ImageArray const& array) {
  auto const rows = array.shape(0), columns = array.shape(1);
  Image<double> image(static_cast<int>(columns), static_cast<int>(rows));
  auto const* const first = static_cast<T const*>(array.data());
  double* to = image.data();
  for (std::size_t row = 0; row < rows; ++row) {
    T const* from = first + static_cast<std::int64_t>(row) * array.stride(0);
    for (std::size_t column = 0; column < columns; ++column, from += array.stride(1)) {
      *to++ = static_cast<double>(*from);
    }
  }
  return image;
}

}  // namespace

GivenImage read_array(ImageArray const& array, std::string const& name) {
  constexpr std::size_t largest = 1u << 20;
  if (array.shape(0) == 0 || array.shape(1) == 0 || array.shape(0) > largest || array.shape(1) > largest) {
    throw DataError(ErrorCode::wrong_shape, name,
                    "has " + std::to_string(array.shape(0)) + " x " + std::to_string(array.shape(1)) +
                        " pixels; give an image [rows, columns]");
  }
  nb::dlpack::dtype const type = array.dtype();
  int const bits = type.bits;
  if (type == nb::dtype<std::uint8_t>()) return {copied<std::uint8_t>(array), bits};
  if (type == nb::dtype<std::uint16_t>()) return {copied<std::uint16_t>(array), bits};
  if (type == nb::dtype<std::uint32_t>()) return {copied<std::uint32_t>(array), bits};
  if (type == nb::dtype<std::int16_t>()) return {copied<std::int16_t>(array), bits};
  if (type == nb::dtype<std::int32_t>()) return {copied<std::int32_t>(array), bits};
  if (type == nb::dtype<std::int64_t>()) return {copied<std::int64_t>(array), bits};
  if (type == nb::dtype<float>()) return {copied<float>(array), bits};
  if (type == nb::dtype<double>()) return {copied<double>(array), bits};
  throw DataError(ErrorCode::wrong_type, name,
                  "has samples of a type that is neither an integer of 8 to 64 bits nor a 32- or 64-bit float; "
                  "convert it, for example with image.astype(numpy.float32)");
}

}  // namespace gladstone::python
