#pragma once

#include <algorithm>

#include "analysis/preparation/frame_preparation.h"

namespace gladstone {

/// A picture as a library's matrix of doubles, such as cv::Mat1d: a view, what is written there stands in the picture.
template <class Matrix>
Matrix view_of(Image<double>& picture) {
  return Matrix(picture.rows(), picture.columns(), picture.data());
}

/// Calls change(levels, known) for either frame, with what is not 0 where pixels are known; not where none is.
template <class Matrix, class Change>
void for_both(PreparedFrames& frames, Change const& change) {
  if (std::all_of(frames.known.begin(), frames.known.end(), [](double known) { return known == 0.0; })) return;
  Matrix const known = view_of<Matrix>(frames.known);
  for (Image<double>* picture : {&frames.reference, &frames.flow}) {
    Matrix levels = view_of<Matrix>(*picture);
    change(levels, known);
  }
}

}  // namespace gladstone
