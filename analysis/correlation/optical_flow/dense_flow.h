#pragma once

#include <vector>

#include "analysis/correlation/bspline_image.h"
#include "analysis/correlation/window_deformation.h"
#include "render/base/vec.h"

/// Optical flow: estimates a displacement for every pixel instead of every window. Provided for comparison with
/// correlation.
namespace gladstone::inline correlation {

/// Grey levels in float, row by row; positions outside the image return the nearest border pixel.
struct GreyImage {
  int columns = 0, rows = 0;
  std::vector<float> level;

  float operator()(int x, int y) const {
    int const i = x < 0 ? 0 : (x < columns ? x : columns - 1), j = y < 0 ? 0 : (y < rows ? y : rows - 1);
    return level[static_cast<std::size_t>(j) * columns + i];
  }
};

/// Displacement field with one vector at the centre of every pixel [px].
struct DenseFlow {
  int columns = 0, rows = 0;
  std::vector<float> u, v;

  DenseFlow() = default;
  DenseFlow(int width, int height)
      : columns(width), rows(height), u(static_cast<std::size_t>(width) * height), v(u.size()) {}
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * columns + x; }
  /// Interpolates the displacement bilinearly between pixels; positions outside the image are clamped to its border.
  Vec2d at(Vec2d position) const;
  /// Returns the flow for an image of twice the resolution: interpolated bilinearly, and doubled.
  DenseFlow finer(int width, int height) const;
};

/// Image pyramid of a frame, finest level first. Each level is blurred by (1 4 6 4 1)/16 along both axes and
/// subsampled, so that pixel i of a level is pixel 2 i of the next finer one. Coarser levels have no side below 24 px.
std::vector<GreyImage> build_pyramid(GreyImage finest);

/// Returns a frame without its local mean (Gaussian, sigma 8 px), divided by its rms, to compensate illumination
/// differences.
GreyImage normalised_frame(GreyImage frame);

/// Estimates the displacement of every pixel, at the mid-position as in a correlation.
/// @param reference,  flow  frames without deformation; unknown pixels contain the middle of the grey levels
using EstimateFlow = DenseFlow (*)(GreyImage const& reference, GreyImage const& flow);

/// Optical flow by Horn & Schunck, Artif. Intell. 17 (1981) 185, on normalised frames, from coarse to fine. Each level
/// deforms both frames by half of the current displacement in opposite directions (cubic B-splines), and solves for the
/// smooth correction that explains the residual difference. Applied to background oriented schlieren by Atcheson,
/// Heidrich & Ihrke, Exp. Fluids 46 (2009) 467.
DenseFlow horn_schunck_flow(GreyImage const& reference, GreyImage const& flow);
/// Range of grey levels whose limits are mapped to 0 and 255.
struct GreyRange {
  float low = 0.0f, high = 0.0f;
};
/// One pixel in this many may exceed the upper limit of joint_range().
constexpr std::size_t brightest_pixels = 10000;
/// Returns the range from the darkest pixel of both frames to the grey level that one pixel in `brightest_pixels`
/// exceeds, so that a few hot pixels do not reduce the grey-level resolution of the other pixels.
GreyRange joint_range(GreyImage const& reference, GreyImage const& flow);

/// Dense inverse search of Kroeger, Timofte, Dai & Van Gool, ECCV 2016, in OpenCV's implementation (cv::DISOpticalFlow)
/// with "medium", the finest of its three presets: patches of 8 px at distances of 3 px, without their mean grey level,
/// 25 descent steps, a finest pyramid level of half the resolution, and five iterations of variational refinement. Both
/// frames are converted to 8 bits by the same joint_range(). The result is half the difference between the forward and
/// the backward flow, so that exchanging the frames reverses its sign. It is computed in one thread, and hence
/// independent of the number of threads.
/// @throws DataError if the frames are too small for the method
DenseFlow dense_inverse_search(GreyImage const& reference, GreyImage const& flow);

}  // namespace gladstone::inline correlation
