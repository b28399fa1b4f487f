#include "render/base/integer_frames.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gladstone {
namespace {

Image<std::uint16_t> make_levels(std::uint16_t first) {
  Image<std::uint16_t> image(3, 2);
  for (std::size_t i = 0; i < image.size(); ++i) image.data()[i] = static_cast<std::uint16_t>(first + 13107 * i);
  return image;
}

template <class A, class B>
bool are_equal(Image<A> const& a, Image<B> const& b) {
  return a.columns() == b.columns() && std::equal(a.begin(), a.end(), b.begin(), b.end());
}

// The integers of a camera come back, whether they were stored as integers or as real numbers.
TEST(IntegerFrames, AreThoseOfTheCamera) {
  Image<std::uint16_t> const a = make_levels(0), b = make_levels(1);
  IntegerFrames const frames({a, b});
  EXPECT_TRUE(are_equal(frames.reference(), a));
  EXPECT_TRUE(are_equal(frames.flow(), b));
  HostFrames const real(frames.reference(), frames.flow());
  for (StoredFrames const* const stored : std::initializer_list<StoredFrames const*>{&frames, &real}) {
    FramePair<std::uint16_t> const integers = stored->integers();
    EXPECT_TRUE(are_equal(integers.reference, a));
    EXPECT_TRUE(are_equal(integers.flow, b));
  }
}

}  // namespace
}  // namespace gladstone
