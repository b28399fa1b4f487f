#include "cuda/device_light.h"

#include <algorithm>

#include "cuda/detect_light.h"
#include "render/base/parallel.h"

namespace gladstone::cuda {

DeviceFrames::DeviceFrames(int columns, int rows) : columns_(columns), rows_(rows) {
  for (auto& levels : levels_) {
    levels = DeviceArray<double>(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), "the images");
  }
}

Image<double> const& DeviceFrames::on_host(Frame frame) const {
  Image<double>& image = on_host_[static_cast<int>(frame)];
  if (image.empty()) {
    image = Image<double>(columns_, rows_);
    levels_[static_cast<int>(frame)].download(image.data(), image.size());
  }
  return image;
}

DeviceLight::DeviceLight(int columns, int rows) : columns_(columns), rows_(rows) {
  for (auto& light : light_) light = DeviceArray<double>(pixels(), "the images");
}

void DeviceLight::take_from(Image<double> const& white) {
  DeviceArray<double> const paper(white.data(), pixels(), "the images");
  for (auto& light : light_) take_from_white(paper.data(), light.data(), pixels());
}

LightPair DeviceLight::to_host(PinnedBuffer& staging) const {
  auto* const staged = static_cast<double*>(staging.reserve(frame_count * pixels() * sizeof(double)));
  light_[0].download(staged, pixels());
  light_[1].download(staged + pixels(), pixels());
  LightPair pair{Image<double>(columns_, rows_), Image<double>(columns_, rows_)};
  parallel_chunks(pixels(), std::size_t{1} << 16, [&](std::size_t begin, std::size_t end) {
    std::copy(staged + begin, staged + end, pair.reference.data() + begin);
    std::copy(staged + pixels() + begin, staged + pixels() + end, pair.flow.data() + begin);
  });
  return pair;
}

double DeviceLight::brightest() const {
  DeviceArray<unsigned long long> key(1, "the images");
  key.zero();
  for (auto const& light : light_) find_brightest(light.data(), pixels(), key.data());
  unsigned long long found = 0;
  key.download(&found, 1);
  return brightest_of(found);
}

RecordedFrames DeviceLight::record(Detector const& detector) const {
  auto frames = std::make_shared<DeviceFrames>(columns_, rows_);
  DeviceArray<unsigned long long> saturated(frame_count, "the images");
  saturated.zero();
  for (Frame const frame : {Frame::reference, Frame::flow}) {
    int const at = static_cast<int>(frame);
    record_levels(detector.pixel(), frame == Frame::flow ? RandomStream::noise_flow : RandomStream::noise_reference,
                  light_[at].data(), pixels(), frames->levels(frame), saturated.data() + at);
  }
  unsigned long long counted[frame_count] = {};
  saturated.download(counted, frame_count);
  return {std::move(frames), counted[0], counted[1]};
}

std::unique_ptr<FramePair const> DeviceLight::ideal(Detector const& detector) const {
  auto frames = std::make_unique<DeviceFrames>(columns_, rows_);
  for (Frame const frame : {Frame::reference, Frame::flow}) {
    ideal_levels(detector.pixel(), light_[static_cast<int>(frame)].data(), pixels(), frames->levels(frame));
  }
  return frames;
}

}  // namespace gladstone::cuda
