#pragma once

#include "analysis/preparation/frame_preparation.h"

/// Readers of all masks and preprocessing steps. Each reads its setup table and returns the operation on the frames.
namespace gladstone {

/// Reads a polygonal mask: `x_px` and `y_px` are the corners of the polygon. Masks the pixels whose centres are inside
/// (even-odd rule).
FrameChange read_polygon_mask(SetupTable& table, FramePreparation& preparation);
/// Reads a mask image: `file` has the size of the frames. Masks the pixels where the image is 0.
FrameChange read_image_mask(SetupTable& table, FramePreparation& preparation);
/// Reads an intensity mask: masks the pixels whose grey level, after a Gaussian filter of standard deviation `blur_px`,
/// is above `above_dn` or below `below_dn` in either frame.
FrameChange read_intensity_mask(SetupTable& table, FramePreparation& preparation);

/// Subtracts a background from each frame: "minimum", "mean" or "median" (`subtract`) of a sequence of frames, computed
/// per pixel and only once. The key `frame` lists the files of this sequence (`reference` and `flow`). If `frame` is
/// missing, the background is computed from the correlated sequence itself, which requires PreparedSet::sequence. Grey
/// levels may become negative.
FrameChange read_background(SetupTable& table, FramePreparation& preparation);
/// Subtracts a Gaussian average of standard deviation `sigma_px` from each frame.
FrameChange read_high_pass(SetupTable& table, FramePreparation& preparation);
/// Applies OpenCV's contrast-limited adaptive histogram equalisation (Zuiderveld, in Graphics Gems IV (1994) 474) over
/// tiles of `tile_px`. Histogram bins are clipped at `clip_limit` times their mean.
FrameChange read_clahe(SetupTable& table, FramePreparation& preparation);
/// Caps grey levels at the frame's median plus `deviations` standard deviations, so that bright particles do not
/// dominate the correlation (Shavit, Lowe & Steinbuck, Exp. Fluids 42 (2007) 225).
FrameChange read_intensity_cap(SetupTable& table, FramePreparation& preparation);
/// Min-max filter: (level - low)/(high - low), where low and high are the local minimum and maximum over squares of
/// `window_px`, both averaged over such a square. The denominator is at least `least_contrast` times the frame's range
/// (Westerweel, Digital Particle Image Velocimetry (1993), section 5).
FrameChange read_min_max(SetupTable& table, FramePreparation& preparation);

}  // namespace gladstone
