#include "cuda/device/cuda_error.h"
#include "cuda/device/device_images.h"
#include "render/sensor/exposure.h"

namespace gladstone::cuda::inline device {
namespace {

__global__ void to_light_kernel(unsigned long long const* fixed_point, double* light, std::size_t count) {
  std::size_t const i = blockIdx.x * std::size_t{blockDim.x} + threadIdx.x;
  if (i < count) light[i] = static_cast<double>(static_cast<long long>(fixed_point[i])) / fixed_point_one;
}

}  // namespace

ImagePairOnDevice::ImagePairOnDevice(int columns, int rows) : columns_(columns), rows_(rows) {
  for (auto& frame : light_) {
    frame = DeviceArray<unsigned long long>(pixels(), "the images");
    frame.zero();
  }
}

DeviceImages ImagePairOnDevice::view(double light_per_weight) {
  return {{light_[0].data(), light_[1].data()}, columns_, rows_, light_per_weight * fixed_point_one};
}

void ImagePairOnDevice::to_light(DeviceLight& light) const {
  constexpr int block = 256;
  for (Frame const frame : {Frame::reference, Frame::flow}) {
    to_light_kernel<<<static_cast<unsigned int>((pixels() + block - 1) / block), block>>>(
        light_[static_cast<int>(frame)].data(), light.light(frame), pixels());
    check_launch("to_light");
  }
}

}  // namespace gladstone::cuda::inline device
