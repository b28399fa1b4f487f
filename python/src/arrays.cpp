#include "python/src/arrays.h"

#include <optional>

#include "render/base/error.h"

namespace gladstone::python {
namespace {

std::optional<SampleKind> kind_of_samples(nb::dlpack::dtype const& type) {
  if (type.lanes != 1) return std::nullopt;
  switch (static_cast<nb::dlpack::dtype_code>(type.code)) {
    case nb::dlpack::dtype_code::Bool:
      return SampleKind::boolean;
    case nb::dlpack::dtype_code::UInt:
      return SampleKind::unsigned_integer;
    case nb::dlpack::dtype_code::Int:
      return SampleKind::signed_integer;
    case nb::dlpack::dtype_code::Float:
      return SampleKind::floating_point;
    default:
      return std::nullopt;
  }
}

}  // namespace

ImageSamples described_image(ImageSamples samples, nb::dlpack::dtype type, std::string const& name) {
  constexpr std::int64_t largest = 1 << 20;
  if (samples.rows == 0 || samples.columns == 0 || samples.rows > largest || samples.columns > largest) {
    throw DataError(ErrorCode::wrong_shape, name,
                    "has " + std::to_string(samples.rows) + " x " + std::to_string(samples.columns) +
                        " pixels; give an image [rows, columns]");
  }
  std::optional<SampleKind> const kind = kind_of_samples(type);
  samples.kind = kind.value_or(SampleKind::boolean);
  samples.bits = kind ? type.bits : 0;
  if (visit_sample_type(samples, [](auto) {})) return samples;
  throw DataError(ErrorCode::wrong_type, name,
                  "has samples of a type that is neither an integer of 8 to 64 bits nor a 32- or 64-bit float; "
                  "convert it, for example with image.astype(numpy.float32)");
}

Image<double> read_samples(ImageSamples const& samples) {
  Image<double> image(static_cast<int>(samples.columns), static_cast<int>(samples.rows));
  visit_sample_type(samples, [&](auto type) {
    auto const* const first = static_cast<decltype(type) const*>(samples.first);
    double* to = image.data();
    for (std::int64_t row = 0; row < samples.rows; ++row) {
      auto const* from = first + row * samples.row_step;
      for (std::int64_t column = 0; column < samples.columns; ++column, from += samples.column_step)
        *to++ = static_cast<double>(*from);
    }
  });
  return image;
}

}  // namespace gladstone::python
