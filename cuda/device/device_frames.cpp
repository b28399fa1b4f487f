#include "cuda/device/device_frames.h"

#include <algorithm>
#include <iterator>

#include "cuda/device/copy_samples.h"

namespace gladstone::cuda {

DeviceFrames::DeviceFrames(int columns, int rows) : columns_(columns), rows_(rows) {
  for (auto& levels : levels_) {
    levels = DeviceArray<double>(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), "the images");
  }
}

DeviceFrames::DeviceFrames(ImageSamples const& reference, ImageSamples const& flow)
    : DeviceFrames(static_cast<int>(reference.columns), static_cast<int>(reference.rows)) {
  DeviceArray<unsigned long long> counts(frame_count, "the images");
  counts.zero();
  for (Frame const frame : {Frame::reference, Frame::flow}) {
    int const index = static_cast<int>(frame);
    copy_samples(frame == Frame::reference ? reference : flow, levels(frame), counts.data() + index);
  }
  unsigned long long on_host[frame_count];
  counts.download(on_host, frame_count);
  std::copy(std::begin(on_host), std::end(on_host), not_finite_);
}

Image<double> const& DeviceFrames::on_host(Frame frame) const {
  Image<double>& image = on_host_[static_cast<int>(frame)];
  if (image.empty()) {
    image = Image<double>(columns_, rows_);
    levels_[static_cast<int>(frame)].download(image.data(), image.size());
  }
  return image;
}

}  // namespace gladstone::cuda
