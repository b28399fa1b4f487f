#include <opencv2/imgproc.hpp>

#include "analysis/preparation/frame_changes.h"
#include "analysis/preparation/grey_levels.h"

namespace gladstone::inline preparation {

FrameChange make_high_pass(double sigma_px) {
  return [sigma_px](PreparedFrames& frames) {
    // Average over valid pixels only: divide the filtered levels by the filtered weights.
    cv::Mat1d weight;
    cv::GaussianBlur(matrix_view<cv::Mat1d>(frames.known), weight, {}, sigma_px);
    for_both<cv::Mat1d>(frames, [&](cv::Mat1d& levels, cv::Mat1d const& known) {
      cv::Mat1d sum, average;
      cv::GaussianBlur(levels.mul(known), sum, {}, sigma_px);
      cv::divide(sum, weight, average);
      levels -= average;
      levels.setTo(0.0, known < 0.5);
    });
  };
}

}  // namespace gladstone::inline preparation
