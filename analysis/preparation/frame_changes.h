#pragma once

#include "analysis/preparation/frame_preparation.h"

/// The readers of all masks and steps: each reads its table and gives what it does.
namespace gladstone {

/// `x_px`, `y_px`: corners of a polygon; pixels whose centres lie inside are left out (even-odd rule).
FrameChange read_polygon_mask(SetupTable& table, FramePreparation& preparation);
/// `file`: a picture of the frames' size; pixels where it is 0 are left out.
FrameChange read_image_mask(SetupTable& table, FramePreparation& preparation);
/// `above_dn`, `below_dn`: pixels brighter or darker in either frame are left out, after a Gaussian average of
/// standard deviation `blur_px`.
FrameChange read_intensity_mask(SetupTable& table, FramePreparation& preparation);

/// `subtract`: "minimum" or "mean" of a sequence of frames, `frame`: tables of `reference` and `flow`, each pixel by
/// itself. Levels may become negative.
FrameChange read_background(SetupTable& table, FramePreparation& preparation);
/// Takes the Gaussian average of standard deviation `sigma_px` off.
FrameChange read_high_pass(SetupTable& table, FramePreparation& preparation);
/// Contrast-limited adaptive histogram equalisation (Zuiderveld, in Graphics Gems IV (1994) 474) by OpenCV, over tiles
/// of `tile_px`, with `clip_limit` times the mean of a histogram's bins.
FrameChange read_clahe(SetupTable& table, FramePreparation& preparation);
/// Caps grey levels at the median plus `deviations` standard deviations of the frame: bright particles do not rule the
/// correlation. Shavit, Lowe & Steinbuck, Exp. Fluids 42 (2007) 225.
FrameChange read_intensity_cap(SetupTable& table, FramePreparation& preparation);
/// (level - low)/(high - low) between the local minimum and maximum over squares of `window_px`, both averaged over
/// such a square; where these differ by less than `least_contrast` of the frame's range, over that. Westerweel,
/// Digital Particle Image Velocimetry (1993), section 5.
FrameChange read_min_max(SetupTable& table, FramePreparation& preparation);

}  // namespace gladstone
