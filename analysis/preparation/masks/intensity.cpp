#include <opencv2/imgproc.hpp>

#include "analysis/preparation/frame_changes.h"
#include "analysis/preparation/grey_levels.h"

namespace gladstone {

FrameChange read_intensity_mask(SetupTable& table, FramePreparation&) {
  std::optional<double> const above = table.optional_number("above_dn"), below = table.optional_number("below_dn");
  double const blur_px = table.number("blur_px", 0.0, Range::at_least(0.0, 512.0));
  if (!table.has("above_dn") && !table.has("below_dn"))
    table.problem("kind",
                  "\"intensity\" requires a level (otherwise nothing is masked); give above_dn, below_dn or both");
  if (above && below && *below > *above)
    table.problem("below_dn", "exceeds above_dn (everything would be masked); exchange them");
  return [above, below, blur_px](PreparedFrames& frames) {
    cv::Mat1d left_out(frames.known.rows(), frames.known.columns(), 0.0);
    for_both<cv::Mat1d>(frames, [&](cv::Mat1d const& levels, cv::Mat1d const&) {
      cv::Mat1d average = levels;
      if (blur_px > 0.0) cv::GaussianBlur(levels, average, {}, blur_px);
      if (above) left_out.setTo(1.0, average > *above);
      if (below) left_out.setTo(1.0, average < *below);
    });
    matrix_view<cv::Mat1d>(frames.known).setTo(0.0, left_out > 0.5);
  };
}

}  // namespace gladstone
