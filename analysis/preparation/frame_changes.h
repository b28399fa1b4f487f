#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/preparation/frame_preparation.h"
#include "render/base/vec.h"

/// All masks and preprocessing steps. Each function returns the operation on the frames for its settings.
namespace gladstone::inline preparation {

/// Masks the pixels whose centres are inside a polygon (even-odd rule).
/// @param corners  corners of the polygon [px]
FrameChange make_polygon_mask(std::vector<Vec2d> const& corners);
/// Masks the pixels where an image of the size of the frames is 0.
FrameChange make_image_mask(std::string const& file);
/// Masks the pixels that are brighter or darker than a limit in either frame, after a Gaussian filter.
/// @param above_dn, below_dn  limits of the grey level [DN]; nullopt: no limit
/// @param blur_px             standard deviation of the filter [px]; 0: no filter
FrameChange make_intensity_mask(std::optional<double> above_dn, std::optional<double> below_dn, double blur_px);

/// Subtracts from each frame the background of listed images, computed per pixel and only once. Grey levels may become
/// negative.
/// @param statistic        one of background_statistics()
/// @param reference, flow  images of frames A and of frames B
FrameChange make_background_subtraction(std::string const& statistic, std::vector<std::string> const& reference,
                                        std::vector<std::string> const& flow);
/// Subtracts the background of a sequence, which is computed before the first pair is prepared.
FrameChange make_background_subtraction(std::shared_ptr<SequenceBackground const> const& background);
/// Subtracts from each frame its local mean, weighted by a Gaussian of standard deviation `sigma_px` [px].
FrameChange make_high_pass(double sigma_px);
/// Applies OpenCV's contrast-limited adaptive histogram equalisation (Zuiderveld, in Graphics Gems IV (1994) 474) over
/// tiles of `tile_px`. Histogram bins are clipped at `clip_limit` times their mean.
FrameChange make_clahe(int tile_px, double clip_limit);
/// Caps grey levels at the frame's median plus `deviations` standard deviations, so that bright particles do not
/// dominate the correlation (Shavit, Lowe & Steinbuck, Exp. Fluids 42 (2007) 225).
FrameChange make_intensity_cap(double deviations);
/// Min-max filter: (level - low)/(high - low), where low and high are the local minimum and maximum over squares of
/// `window_px`, both averaged over such a square. The denominator is at least `least_contrast` times the frame's range
/// (Westerweel, Digital Particle Image Velocimetry (1993), section 5).
FrameChange make_min_max(int window_px, double least_contrast);

}  // namespace gladstone::inline preparation
