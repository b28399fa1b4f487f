#include "render/scene/rendered_light.h"

#include <algorithm>
#include <utility>

#include "render/base/integer_frames.h"

namespace gladstone::inline scene {

double HostLight::brightest() const {
  return std::max(*std::max_element(light_.reference.begin(), light_.reference.end()),
                  *std::max_element(light_.flow.begin(), light_.flow.end()));
}

RecordedFrames HostLight::record(Detector const& detector) const {
  Recording reference = detector.record(light_.reference, RandomStream::noise_reference);
  Recording flow = detector.record(light_.flow, RandomStream::noise_flow);
  FramePair<std::uint16_t> levels{std::move(reference.image), std::move(flow.image)};
  return {std::make_shared<IntegerFrames const>(std::move(levels)), reference.saturated, flow.saturated};
}

std::unique_ptr<StoredFrames const> HostLight::ideal(Detector const& detector) const {
  return std::make_unique<HostFrames const>(detector.ideal(light_.reference), detector.ideal(light_.flow));
}

}  // namespace gladstone::inline scene
