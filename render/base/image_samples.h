#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "render/base/frame_pair.h"

namespace gladstone::inline base {

/// Kind of the samples of an array.
enum class SampleKind { boolean, unsigned_integer, signed_integer, floating_point };

/// Grey levels of an image in the memory (host or device) of another library, of any sample type and memory layout.
struct ImageSamples {
  void const* first = nullptr;                 ///< address of the sample in row 0 and column 0
  SampleKind kind = SampleKind::boolean;       ///< kind of the samples
  int bits = 8;                                ///< size of a sample [bit]
  std::int64_t columns = 0, rows = 0;          ///< size of the image [px]
  std::int64_t column_step = 1, row_step = 0;  ///< distances between adjacent columns and rows [samples]
};

/// Frames copied from ImageSamples, and the number of NaN or infinite pixels of each.
struct CopiedFrames {
  std::unique_ptr<StoredFrames> frames;
  std::array<std::size_t, 2> not_finite;
};

/// Calls `visit` with a value of the samples' C++ type: bool, an integer of 8 to 64 bits, float or double.
/// @return false if no C++ type has this kind and size; `visit` is then not called
template <class Visit>
bool visit_sample_type(ImageSamples const& image, Visit const& visit) {
  auto const integer = [&](auto one_byte, auto two_bytes, auto four_bytes, auto eight_bytes) {
    if (image.bits == 8) return visit(one_byte), true;
    if (image.bits == 16) return visit(two_bytes), true;
    if (image.bits == 32) return visit(four_bytes), true;
    if (image.bits == 64) return visit(eight_bytes), true;
    return false;
  };
  switch (image.kind) {
    case SampleKind::boolean:
      return image.bits == 8 && (visit(bool{}), true);
    case SampleKind::unsigned_integer:
      return integer(std::uint8_t{}, std::uint16_t{}, std::uint32_t{}, std::uint64_t{});
    case SampleKind::signed_integer:
      return integer(std::int8_t{}, std::int16_t{}, std::int32_t{}, std::int64_t{});
    case SampleKind::floating_point:
      if (image.bits == 32) return visit(float{}), true;
      return image.bits == 64 && (visit(double{}), true);
  }
  return false;
}

}  // namespace gladstone::inline base
