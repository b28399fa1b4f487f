#include <fmt/format.h>

#include <mutex>
#include <opencv2/video/tracking.hpp>

#include "analysis/correlation/optical_flow/dense_flow.h"
#include "analysis/preparation/opencv_call.h"

namespace gladstone::inline correlation {
namespace {

/// RAII guard that restricts OpenCV to one thread, so that the result does not depend on the number of threads: OpenCV
/// divides the image into one strip per thread, and starts the search of a patch from its neighbours in the same strip.
class OneThread {
 public:
  OneThread() : turn_(one_at_a_time()), before_(cv::getNumThreads()) { cv::setNumThreads(1); }
  ~OneThread() { cv::setNumThreads(before_); }
  OneThread(OneThread const&) = delete;
  OneThread& operator=(OneThread const&) = delete;

 private:
  static std::mutex& one_at_a_time() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> turn_;
  int before_;
};

cv::Mat eight_bits(GreyImage const& frame, GreyRange const& range) {
  cv::Mat grey(frame.rows, frame.columns, CV_8UC1);
  float const scale = range.high > range.low ? 255.0f / (range.high - range.low) : 0.0f;
  for (int j = 0; j < frame.rows; ++j)
    for (int i = 0; i < frame.columns; ++i)
      grey.at<std::uint8_t>(j, i) = cv::saturate_cast<std::uint8_t>(scale * (frame(i, j) - range.low));
  return grey;
}

/// Returns the displacement from the first frame to the second one, at the pixel midway between both positions.
DenseFlow one_way(cv::Mat const& from, cv::Mat const& to) {
  cv::Mat found;
  call_opencv(ErrorCode::unsupported, "image pair",
              fmt::format("compute the optical flow of frames of {} x {} px", from.cols, from.rows), [&] {
                OneThread const one_thread;
                cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM)->calc(from, to, found);
              });
  DenseFlow d(from.cols, from.rows);
  for (int j = 0; j < d.rows; ++j)
    for (int i = 0; i < d.columns; ++i) {
      auto const& value = found.at<cv::Vec2f>(j, i);
      d.u[d.index(i, j)] = value[0];
      d.v[d.index(i, j)] = value[1];
    }
  // OpenCV's flow belongs to the dot positions in the first frame; fixed-point iteration transfers it to the
  // mid-position.
  DenseFlow middle(d.columns, d.rows);
  for (int j = 0; j < d.rows; ++j)
    for (int i = 0; i < d.columns; ++i) {
      Vec2d const centre{static_cast<double>(i), static_cast<double>(j)};
      Vec2d value = d.at(centre);
      for (int k = 0; k < 3; ++k) value = d.at(centre - 0.5 * value);
      middle.u[middle.index(i, j)] = static_cast<float>(value.x);
      middle.v[middle.index(i, j)] = static_cast<float>(value.y);
    }
  return middle;
}

}  // namespace

DenseFlow dense_inverse_search(GreyImage const& reference, GreyImage const& flow) {
  GreyRange const range = joint_range(reference, flow);
  cv::Mat const first = eight_bits(reference, range), second = eight_bits(flow, range);
  DenseFlow d = one_way(first, second);
  DenseFlow const back = one_way(second, first);
  for (std::size_t k = 0; k < d.u.size(); ++k) {
    d.u[k] = 0.5f * (d.u[k] - back.u[k]);
    d.v[k] = 0.5f * (d.v[k] - back.v[k]);
  }
  return d;
}

}  // namespace gladstone::inline correlation
