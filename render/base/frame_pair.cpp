#include "render/base/frame_pair.h"

#include <algorithm>

namespace gladstone::inline base {

Image<std::uint16_t> integer_levels(Image<double> const& levels) {
  Image<std::uint16_t> image(levels.columns(), levels.rows());
  std::transform(levels.begin(), levels.end(), image.begin(),
                 [](double level) { return static_cast<std::uint16_t>(level); });
  return image;
}

FramePair<std::uint16_t> StoredFrames::integers() const {
  return {integer_levels(reference()), integer_levels(flow())};
}

}  // namespace gladstone::inline base
