#pragma once

#include "analysis/preparation/frame_preparation.h"

/// Readers of all masks and preprocessing steps. Each reads its setup table and returns the operation on the frames.
namespace gladstone {

/// `x_px`, `y_px`: corners of a polygon. Masks the pixels whose centres are inside (even-odd rule).
FrameChange read_polygon_mask(SetupTable& table, FramePreparation& preparation);
/// `file`: image of the size of the frames. Masks the pixels where it is 0.
FrameChange read_image_mask(SetupTable& table, FramePreparation& preparation);
/// `above_dn`, `below_dn`: limits of the grey level. Masks the pixels that are brighter or darker in either frame,
/// after a Gaussian filter of standard deviation `blur_px`.
FrameChange read_intensity_mask(SetupTable& table, FramePreparation& preparation);

/// Subtracts a background from each frame: "minimum", "mean" or "median" (`subtract`) of a sequence of frames, computed
/// per pixel and only once. `frame`: tables with the files of `reference` and `flow`; if it is missing, the background
/// is that of the sequence, in a preparation of PreparedSet::sequence. Grey levels may become negative.
FrameChange read_background(SetupTable& table, FramePreparation& preparation);
/// Subtracts a Gaussian average of standard deviation `sigma_px`.
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
