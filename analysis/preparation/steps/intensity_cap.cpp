#include <opencv2/core.hpp>
#include <utility>

#include "analysis/preparation/frame_changes.h"
#include "analysis/preparation/grey_levels.h"
#include "render/base/median.h"

namespace gladstone::inline preparation {

FrameChange make_intensity_cap(double deviations) {
  return [deviations](PreparedFrames& frames) {
    for_both<cv::Mat1d>(frames, [&](cv::Mat1d& levels, cv::Mat1d const& known) {
      std::vector<double> values;
      for (int j = 0; j < levels.rows; ++j)
        for (int i = 0; i < levels.cols; ++i)
          if (known(j, i) != 0.0) values.push_back(levels(j, i));
      cv::Scalar mean, deviation;
      cv::meanStdDev(levels, mean, deviation, known > 0.5);
      cv::min(levels, upper_median(std::move(values)) + deviations * deviation[0], levels);
    });
  };
}

}  // namespace gladstone::inline preparation
