#pragma once

#include <vector>

#include "analysis/correlation/bspline_image.h"
#include "analysis/correlation/window_deformation.h"
#include "render/base/vec.h"

/// Optical flow: a displacement for every pixel instead of one for every window. It is here to be compared with.
namespace gladstone {

/// Grey levels in float, row by row; beyond the border its outermost pixels go on.
struct GreyImage {
  int columns = 0, rows = 0;
  std::vector<float> level;

  float operator()(int x, int y) const {
    int const i = x < 0 ? 0 : (x < columns ? x : columns - 1), j = y < 0 ? 0 : (y < rows ? y : rows - 1);
    return level[static_cast<std::size_t>(j) * columns + i];
  }
};

/// A displacement at every pixel's centre [px].
struct DenseFlow {
  int columns = 0, rows = 0;
  std::vector<float> u, v;

  DenseFlow() = default;
  DenseFlow(int width, int height)
      : columns(width), rows(height), u(static_cast<std::size_t>(width) * height), v(u.size()) {}
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * columns + x; }
  /// Bilinear between pixels; beyond the outermost as there.
  Vec2d at(Vec2d position) const;
  /// Of an image twice as fine: twice as large, bilinear.
  DenseFlow finer(int width, int height) const;
};

/// A frame and its halves: each level blurred by (1 4 6 4 1)/16 along either axis, every other pixel taken, so that
/// pixel i of a level is pixel 2 i of the one before. The finest first; no side below 24 px, but for the finest's.
std::vector<GreyImage> pyramid_of(GreyImage finest);

/// A frame less its local mean (Gaussian, 8 px), over its rms: light that differs between frames does no harm then.
GreyImage normalised_frame(GreyImage frame);

/// A displacement for every pixel, that belongs to the mid-position as a correlation's does.
/// @param reference, flow as they were taken; what is not known holds the middle of the grey levels
using EstimateFlow = DenseFlow (*)(GreyImage const& reference, GreyImage const& flow);

/// Horn & Schunck, Artif. Intell. 17 (1981) 185, from coarse to fine: each level deforms both frames by half of what is
/// known in opposite directions (cubic B-splines), and finds the smooth displacement whose remainder explains what is
/// left. Of normalised frames. For background oriented schlieren: Atcheson, Heidrich & Ihrke, Exp. Fluids 46 (2009)
/// 467.
DenseFlow horn_schunck_flow(GreyImage const& reference, GreyImage const& flow);
/// Grey levels that become 0 and 255.
struct GreyRange {
  float low = 0.0f, high = 0.0f;
};
/// One pixel in so many may be brighter than what becomes 255.
constexpr std::size_t brightest_pixels = 10000;
/// From the darkest pixel of both frames to the one that one in brightest_pixels of them is brighter than, so that a
/// few hot ones do not take the others' levels away.
GreyRange joint_range(GreyImage const& reference, GreyImage const& flow);

/// Dense inverse search of Kroeger, Timofte, Dai & Van Gool, ECCV 2016, as OpenCV has it (cv::DISOpticalFlow): its
/// "medium" preset, the finest of three (patches of 8 px, 3 px apart, 25 steps, down to half of the resolution, five
/// rounds of variational refinement; patches less their mean). It takes frames of 8 bits: both are scaled by the same
/// joint_range(). The result is half the difference of the flows from one frame to the other and back, so that
/// exchanged frames give the negative one. It does not depend on the number of threads: it works with one.
/// @throws DataError where the frames are too small for it
DenseFlow dense_inverse_search(GreyImage const& reference, GreyImage const& flow);

}  // namespace gladstone
