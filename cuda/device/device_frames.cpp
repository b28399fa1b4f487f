#include "cuda/device/device_frames.h"

namespace gladstone::cuda::inline device {

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

}  // namespace gladstone::cuda::inline device
