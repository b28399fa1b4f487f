#include "analysis/preparation/frame_sized_image.h"

#include <fmt/format.h>

#include "render/base/error.h"
#include "render/files/image_file.h"

namespace gladstone::inline preparation {

Image<double> read_frame_sized_image(std::string const& file, Image<double> const& frame) {
  Image<double> picture = read_image(file);
  if (picture.columns() != frame.columns() || picture.rows() != frame.rows())
    throw DataError(ErrorCode::wrong_shape, file,
                    fmt::format("is {} x {} px, but the frames are {} x {} px (the two are combined pixel by "
                                "pixel); give an image of that size",
                                picture.columns(), picture.rows(), frame.columns(), frame.rows()));
  if (std::size_t const bad = count_not_finite(picture); bad > 0)
    throw DataError(ErrorCode::invalid_value, file,
                    fmt::format("{} of {} pixels are nan or infinite (which is neither a mask value nor a grey level); "
                                "replace them by numbers, in a mask by 0 where the frames are to be masked",
                                bad, picture.size()));
  return picture;
}

}  // namespace gladstone::inline preparation
