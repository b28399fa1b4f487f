#include <string>

#include "cuda/backend.h"
#include "render/base/error.h"

namespace gladstone::cuda {

bool compiled_in() { return false; }

std::string description() { return "not compiled in (no CUDA toolkit was found when this was built)"; }

DeviceState device_state() { return {false, "this gladstone was built without CUDA"}; }

int device_count() { return 0; }

int device_of_memory(void const*) { return -1; }

std::unique_ptr<Renderer> make_renderer() { throw DeviceError(device_state().text); }

std::unique_ptr<Renderer> make_rays_renderer() { throw DeviceError(device_state().text); }

std::unique_ptr<ImageDrawer> make_image_drawer() { throw DeviceError(device_state().text); }

std::unique_ptr<PairBatchRenderer> make_pair_batches(std::vector<OwnedPairModel> const&) {
  throw DeviceError(device_state().text);
}

std::unique_ptr<Correlator> make_correlator(CorrelationSettings const&) { throw DeviceError(device_state().text); }

CopiedFrames copy_frames(ImageSamples const&, ImageSamples const&) { throw DeviceError(device_state().text); }

std::unique_ptr<SartVolume> make_volume(SartProblem const&) { throw DeviceError(device_state().text); }

}  // namespace gladstone::cuda
