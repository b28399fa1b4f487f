#include "render/base/integer_frames.h"

#include <algorithm>

namespace gladstone::inline base {
namespace {

Image<double> to_real_numbers(Image<std::uint16_t> const& levels) {
  Image<double> image(levels.columns(), levels.rows());
  std::copy(levels.begin(), levels.end(), image.begin());
  return image;
}

}  // namespace

FramePair<double> const& IntegerFrames::real_numbers() const {
  std::call_once(converted_, [this] {
    real_numbers_ = {to_real_numbers(levels_.reference), to_real_numbers(levels_.flow)};
  });
  return real_numbers_;
}

}  // namespace gladstone::inline base
