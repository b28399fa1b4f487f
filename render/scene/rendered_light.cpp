#include "render/scene/rendered_light.h"

#include <algorithm>

namespace gladstone::inline scene {
namespace {

/// Converts a recorded image to the grey levels that correlation reads, identical to those in the image file.
Image<double> grey_levels(Recording const& recording) {
  Image<double> levels(recording.image.columns(), recording.image.rows());
  std::copy(recording.image.begin(), recording.image.end(), levels.begin());
  return levels;
}

}  // namespace

double HostLight::brightest() const {
  return std::max(*std::max_element(light_.reference.begin(), light_.reference.end()),
                  *std::max_element(light_.flow.begin(), light_.flow.end()));
}

RecordedFrames HostLight::record(Detector const& detector) const {
  Recording const reference = detector.record(light_.reference, RandomStream::noise_reference);
  Recording const flow = detector.record(light_.flow, RandomStream::noise_flow);
  return {std::make_shared<HostFrames const>(grey_levels(reference), grey_levels(flow)), reference.saturated,
          flow.saturated};
}

std::unique_ptr<StoredFrames const> HostLight::ideal(Detector const& detector) const {
  return std::make_unique<HostFrames const>(detector.ideal(light_.reference), detector.ideal(light_.flow));
}

}  // namespace gladstone::inline scene
