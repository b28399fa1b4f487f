#include "analysis/preparation/frame_preparation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/preparation/opencv_call.h"
#include "render/base/contracts.h"

namespace gladstone::inline preparation {
namespace {

/// Replaces invalid pixels by the mean grey level of the valid ones.
void fill_unknown(PreparedFrames& frames) {
  for (Image<double>* picture : {&frames.reference, &frames.flow}) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < picture->size(); ++i) {
      if (frames.known.data()[i] == 0.0) continue;
      sum += picture->data()[i];
      count += 1.0;
    }
    double const mean = count > 0.0 ? sum / count : 0.0;
    for (std::size_t i = 0; i < picture->size(); ++i)
      if (frames.known.data()[i] == 0.0) picture->data()[i] = mean;
  }
}

}  // namespace

HostFrames prepare_frames(StoredFrames const& frames, FramePreparation const& preparation) {
  Image<double> const &reference = frames.reference(), &flow = frames.flow();
  GLADSTONE_EXPECTS(reference.columns() == flow.columns() && reference.rows() == flow.rows());
  PreparedFrames prepared{{reference, flow}, Image<double>(reference.columns(), reference.rows(), 1.0)};
  for (std::size_t i = 0; i < reference.size(); ++i)
    if (!std::isfinite(reference.data()[i]) || !std::isfinite(flow.data()[i])) prepared.known.data()[i] = 0.0;
  fill_unknown(prepared);
  call_opencv(ErrorCode::internal, "image", "prepare the frames", [&] {
    for (FrameChange const& mask : preparation.masks) mask(prepared);
    fill_unknown(prepared);
    for (FrameChange const& step : preparation.steps) step(prepared);
  });
  for (std::size_t i = 0; i < reference.size(); ++i)
    if (prepared.known.data()[i] == 0.0)
      prepared.reference.data()[i] = prepared.flow.data()[i] = std::numeric_limits<double>::quiet_NaN();
  return {std::move(prepared.reference), std::move(prepared.flow)};
}

double valid_pixel_fraction(StoredFrames const& frames) {
  Image<double> const& reference = frames.reference();
  auto const known = std::count_if(reference.begin(), reference.end(), [](double level) { return level == level; });
  return reference.empty() ? 0.0 : static_cast<double>(known) / static_cast<double>(reference.size());
}

}  // namespace gladstone::inline preparation
