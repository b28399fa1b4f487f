#include <opencv2/imgproc.hpp>

#include "analysis/preparation/frame_changes.h"
#include "analysis/preparation/grey_levels.h"

namespace gladstone::inline preparation {

FrameChange make_intensity_mask(std::optional<double> above_dn, std::optional<double> below_dn, double blur_px) {
  return [above_dn, below_dn, blur_px](PreparedFrames& frames) {
    cv::Mat1d left_out(frames.known.rows(), frames.known.columns(), 0.0);
    for_both<cv::Mat1d>(frames, [&](cv::Mat1d const& levels, cv::Mat1d const&) {
      cv::Mat1d average = levels;
      if (blur_px > 0.0) cv::GaussianBlur(levels, average, {}, blur_px);
      if (above_dn) left_out.setTo(1.0, average > *above_dn);
      if (below_dn) left_out.setTo(1.0, average < *below_dn);
    });
    matrix_view<cv::Mat1d>(frames.known).setTo(0.0, left_out > 0.5);
  };
}

}  // namespace gladstone::inline preparation
