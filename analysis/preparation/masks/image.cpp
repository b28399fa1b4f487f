#include "analysis/preparation/frame_changes.h"
#include "analysis/preparation/frame_sized_image.h"

namespace gladstone::inline preparation {

FrameChange make_image_mask(std::string const& file) {
  return [file](PreparedFrames& frames) {
    Image<double> const picture = read_frame_sized_image(file, frames.known);
    for (std::size_t i = 0; i < picture.size(); ++i)
      if (!(picture.data()[i] != 0.0)) frames.known.data()[i] = 0.0;
  };
}

}  // namespace gladstone::inline preparation
