#pragma once

#include <algorithm>

#include "analysis/preparation/frame_preparation.h"

namespace gladstone::inline preparation {

/// Returns a library's matrix of doubles, such as cv::Mat1d, as a view on an image; writing to it changes the image.
template <class Matrix>
Matrix matrix_view(Image<double>& picture) {
  return Matrix(picture.rows(), picture.columns(), picture.data());
}

/// Calls change(levels, known) for each of the two frames; `known` is nonzero at valid pixels. Does nothing if no pixel
/// is valid.
template <class Matrix, class Change>
void for_both(PreparedFrames& frames, Change const& change) {
  if (std::all_of(frames.known.begin(), frames.known.end(), [](double known) { return known == 0.0; })) return;
  Matrix const known = matrix_view<Matrix>(frames.known);
  for (Image<double>* picture : {&frames.reference, &frames.flow}) {
    Matrix levels = matrix_view<Matrix>(*picture);
    change(levels, known);
  }
}

}  // namespace gladstone::inline preparation
