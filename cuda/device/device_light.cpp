#include "cuda/device/device_light.h"

#include <algorithm>

#include "cuda/device/cuda_error.h"
#include "cuda/device/detect_light.h"
#include "render/base/parallel.h"

namespace gladstone::cuda::inline device {
namespace {

/// Asynchronous copy from the device to page-locked memory.
class CopyToHost {
 public:
  CopyToHost(double* to, double const* from, std::size_t count) : to_(to) {
    check(cudaEventCreateWithFlags(&done_, cudaEventDisableTiming), "cudaEventCreate");
    cudaError_t status = cudaMemcpyAsync(to, from, count * sizeof(double), cudaMemcpyDeviceToHost);
    if (status == cudaSuccess) status = cudaEventRecord(done_);
    if (status != cudaSuccess) cudaEventDestroy(done_);
    check(status, "cudaMemcpyAsync from the device");
  }
  CopyToHost(CopyToHost const&) = delete;
  CopyToHost& operator=(CopyToHost const&) = delete;
  ~CopyToHost() {
    cudaEventSynchronize(done_);  // the copy must not write to the memory after its release
    cudaEventDestroy(done_);
  }
  /// Waits for the copy and returns the values.
  double const* wait() const {
    check(cudaEventSynchronize(done_), "cudaMemcpyAsync from the device");
    return to_;
  }

 private:
  double* to_;
  cudaEvent_t done_ = nullptr;
};

}  // namespace

DeviceLight::DeviceLight(int columns, int rows) : columns_(columns), rows_(rows) {
  for (auto& light : light_) light = DeviceArray<double>(pixels(), "the images");
}

void DeviceLight::take_from(Image<double> const& white) {
  DeviceArray<double> const paper(white.data(), pixels(), "the images");
  for (auto& light : light_) take_from_white(paper.data(), light.data(), pixels());
}

FramePair<double> DeviceLight::to_host(PinnedBuffer& staging) const {
  auto* const staged = static_cast<double*>(staging.reserve(frame_count * pixels() * sizeof(double)));
  CopyToHost const reference(staged, light_[0].data(), pixels());
  CopyToHost const flow(staged + pixels(), light_[1].data(), pixels());
  FramePair<double> pair{Image<double>(columns_, rows_), Image<double>(columns_, rows_)};
  auto const copy_on = [&](CopyToHost const& copy, Image<double>& image) {
    double const* const arrived = copy.wait();
    parallel_chunks(pixels(), std::size_t{1} << 16, [&](std::size_t begin, std::size_t end) {
      std::copy(arrived + begin, arrived + end, image.data() + begin);
    });
  };
  copy_on(reference, pair.reference);
  copy_on(flow, pair.flow);
  return pair;
}

FramePair<double> DeviceLight::to_host() const {
  PinnedBuffer staging;
  return to_host(staging);
}

double DeviceLight::brightest() const {
  DeviceArray<unsigned long long> key(1, "the images");
  key.zero();
  for (auto const& light : light_) find_brightest(light.data(), pixels(), key.data());
  unsigned long long found = 0;
  key.download(&found, 1);
  return brightness_from_key(found);
}

RecordedFrames DeviceLight::record(Detector const& detector) const {
  auto frames = std::make_shared<DeviceFrames>(columns_, rows_);
  DeviceArray<unsigned long long> saturated(frame_count, "the images");
  saturated.zero();
  PixelDetector pixel = detector.pixel();
  DeviceArray<double> glare;
  if (pixel.glare_e) {
    glare = DeviceArray<double>(pixel.glare_e, pixels(), "the glare");
    pixel.glare_e = glare.data();
  }
  for (Frame const frame : {Frame::reference, Frame::flow}) {
    int const at = static_cast<int>(frame);
    record_levels(pixel, frame == Frame::flow ? RandomStream::noise_flow : RandomStream::noise_reference,
                  light_[at].data(), pixels(), frames->levels(frame), saturated.data() + at);
  }
  unsigned long long counted[frame_count] = {};
  saturated.download(counted, frame_count);
  return {std::move(frames), counted[0], counted[1]};
}

std::unique_ptr<StoredFrames const> DeviceLight::ideal(Detector const& detector) const {
  auto frames = std::make_unique<DeviceFrames>(columns_, rows_);
  for (Frame const frame : {Frame::reference, Frame::flow}) {
    ideal_levels(detector.pixel(), light_[static_cast<int>(frame)].data(), pixels(), frames->levels(frame));
  }
  return frames;
}

}  // namespace gladstone::cuda::inline device
